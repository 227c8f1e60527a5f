"""A measured reflectance: a table over directions of light and view, interpolated."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from renderer.core.params import param
from renderer.core.technique import Arrays, Bake
from renderer.directional.brdf.materials import brdf_bake, table_of
from renderer.directional.brdf.resident import DECLARATIONS, plane, rulers, table_macros, table_uniforms
from renderer.directional.lamp import LAMP_DECLARATIONS, lamp_values
from renderer.directional.technique import DirectionalTechnique

if TYPE_CHECKING:
    from renderer.gl.context import GL
    from renderer.gl.program import AnyTexture

HALF_FROM = 400_000
"""Values from which a table is held in half precision, to stay in the caches."""


def table_textures(gl: GL, baked: Mapping[str, Arrays], storage: str) -> dict[str, AnyTexture]:
    """A table and its rulers on the GPU."""
    table = table_of(baked["brdf"])
    half = storage == "half" or (storage == "auto" and table.values.size // 3 >= HALF_FROM)
    texels = plane(table, np.float16 if half else np.float32)
    return {"table": gl.texture2d(texels, "nearest"), "rulers": gl.texture2d(rulers(table), "nearest")}


class MeasuredBrdf(DirectionalTechnique):
    """Points reflect as a table says, which a goniometer measured or a rule filled."""

    title: ClassVar[str] = "Measured BRDF"
    caption: ClassVar[str] = "A table over directions of light and view, by five bilinear interpolations."
    paper: ClassVar[str] = "Porquet 2005, section 3.3.2.2"
    includes: ClassVar[tuple[str, ...]] = ("directional/brdf_table.glsl", "directional/sources.glsl")
    textures: ClassVar[Mapping[str, str]] = {"table": "sampler2D", "rulers": "sampler2D"}
    extra_declarations: ClassVar[tuple[str, ...]] = (DECLARATIONS, LAMP_DECLARATIONS)

    kind: Literal["measured_brdf"] = "measured_brdf"
    storage: Literal["auto", "half", "float"] = param(
        "auto",
        label="Storage",
        help="Type of the table's numbers on the GPU; auto halves large tables.",
        cost="host",
    )
    ambient: float = param(0.3, label="Ambient", help="Share of the sky's light.", unit="ratio", ge=0, le=1)

    def bakes(self, state: Any) -> list[Bake]:
        """The material's table."""
        return [brdf_bake(state.material)]

    def constants(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, Any]:
        """How the table lies in its texture, and where the lamp is."""
        return table_uniforms(table_of(baked["brdf"])) | lamp_values(state.lamp, baked)

    def macros(self, baked: Mapping[str, Arrays]) -> Mapping[str, int]:
        """How the table's axes count."""
        return table_macros(table_of(baked["brdf"]))

    def textures_key(self, baked_keys: Mapping[str, str]) -> Hashable:
        """The table, and how it is kept."""
        return baked_keys["brdf"], self.storage

    def textures_of(self, gl: GL, baked: Mapping[str, Arrays]) -> dict[str, AnyTexture]:
        """The table and its rulers."""
        return table_textures(gl, baked, self.storage)
