"""Everything at once: Phong's model or a measured reflectance in sun and lamp, and the surroundings."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from renderer.core.params import param
from renderer.core.technique import Arrays, Bake
from renderer.directional.brdf.materials import brdf_bake, table_of
from renderer.directional.brdf.resident import DECLARATIONS as TABLE_DECLARATIONS
from renderer.directional.brdf.resident import table_macros, table_uniforms
from renderer.directional.environment_light import SHARPEST, level_of
from renderer.directional.environments import DECLARATIONS, environment_bake
from renderer.directional.lamp import LAMP_DECLARATIONS, lamp_values
from renderer.directional.light.environment import picture_texture, surroundings
from renderer.directional.light.measured_brdf import table_textures
from renderer.directional.technique import DirectionalTechnique

if TYPE_CHECKING:
    from renderer.gl.context import GL
    from renderer.gl.program import AnyTexture


class Combined(DirectionalTechnique):
    """Points are lit by sun, lamp and surroundings together, each share by itself."""

    title: ClassVar[str] = "Combined"
    caption: ClassVar[str] = "Sun and lamp by Phong or a measured table, and the surroundings, in shares of one's own."
    paper: ClassVar[str] = "Porquet 2005, section 3.3.2"
    includes: ClassVar[tuple[str, ...]] = (
        "directional/phong_lobe.glsl",
        "directional/brdf_table.glsl",
        "directional/sources.glsl",
        "lib/sky.glsl",
        "directional/environment_light.glsl",
    )
    textures: ClassVar[Mapping[str, str]] = {
        "table": "sampler2D",
        "rulers": "sampler2D",
        "environment": "sampler2D",
    }
    extra_declarations: ClassVar[tuple[str, ...]] = (
        TABLE_DECLARATIONS,
        LAMP_DECLARATIONS,
        DECLARATIONS,
        "uniform float light_level; // of the picture",
    )

    kind: Literal["combined"] = "combined"
    surface: Literal["phong", "measured"] = param(
        "measured", label="Surface", help="How sun and lamp are returned.", cost="build"
    )
    storage: Literal["auto", "half", "float"] = param(
        "auto", label="Storage", help="Type of the table's numbers on the GPU; auto halves large tables.", cost="host"
    )
    surface_share: float = param(
        1.0, label="Sun and lamp", help="Share of what they send by the surface.", unit="ratio", ge=0, le=4
    )
    diffuse: float = param(
        0.6, label="Diffuse", help="Share of the light that Phong's surface returns to all sides.", ge=0, le=1
    )
    specular: float = param(0.15, label="Specular", help="Share of its highlight.", unit="ratio", ge=0, le=1)
    shininess: float = param(
        40.0, label="Shininess", help="Exponent of its highlight.", ge=1, le=2000, source="Phong 1975"
    )
    environment_share: float = param(
        1.0, label="Surroundings", help="Share of what they send.", unit="ratio", ge=0, le=4
    )
    matt: float = param(
        0.4, label="Matt", help="Share of the surroundings' light that is returned to all sides.", ge=0, le=1
    )
    mirror: float = param(0.3, label="Mirror", help="Share of it that is mirrored.", unit="ratio", ge=0, le=1)
    mirror_shininess: float = param(
        60.0,
        label="Mirror's shininess",
        help="Exponent of the lobe through which a picture is mirrored; at its most it is a mirror. The sky is always "
        "mirrored sharp.",
        cost="host",
        ge=2,
        le=SHARPEST,
        source="Kautz & McCool 2000",
    )

    def bakes(self, state: Any) -> list[Bake]:
        """The material's table, where it is used, and the surroundings' picture."""
        table = [brdf_bake(state.material)] if self.surface == "measured" else []
        return [*table, *environment_bake(state.environment)]

    def constants(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, Any]:
        """Where the lamp is, the surroundings' light at the moment, and how the table lies in its texture."""
        table = table_uniforms(table_of(baked["brdf"])) if self.surface == "measured" else {}
        values = table | lamp_values(state.lamp, baked) | surroundings(state, baked)
        return values | {"light_level": level_of(self.mirror_shininess)}

    def macros(self, baked: Mapping[str, Arrays]) -> Mapping[str, int]:
        """How the table's axes count, where it is used."""
        none = {"TABLE_COORDINATES": 0, "TABLE_VIEWS": 2}
        return table_macros(table_of(baked["brdf"])) if self.surface == "measured" else none

    def textures_key(self, baked_keys: Mapping[str, str]) -> Hashable:
        """The table, how it is kept, and the picture."""
        return baked_keys.get("brdf") if self.surface == "measured" else "", self.storage, baked_keys.get("environment")

    def textures_of(self, gl: GL, baked: Mapping[str, Arrays]) -> dict[str, AnyTexture]:
        """The table and its rulers, where it is used, and the picture."""
        table = table_textures(gl, baked, self.storage) if self.surface == "measured" else {}
        return table | picture_texture(gl, baked)
