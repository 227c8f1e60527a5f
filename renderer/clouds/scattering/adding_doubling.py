"""The accurate technique: every order of scattering by doubling, tabulated, with order 1 exact."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

import numpy as np

from renderer.clouds import slab_axes as axes
from renderer.clouds import slab_tables as tables
from renderer.clouds.phase_tables import look_up, table_place
from renderer.clouds.slab import Slab, direct, first_down, first_up
from renderer.clouds.technique import ScatteringTechnique
from renderer.core.params import param
from renderer.core.technique import Arrays, Bake

Order = Literal["all", "forward", "single", "rest"]


class AddingDoubling(ScatteringTechnique):
    """The layer's true answer to a beam, read from tables."""

    title: ClassVar[str] = "Adding and doubling"
    caption: ClassVar[str] = "All orders of scattering by the true phase function, computed once and tabulated."
    paper: ClassVar[str] = "van de Hulst 1963; Hansen 1971; Wiscombe 1977; Nakajima & Tanaka 1988"
    textures: ClassVar[Mapping[str, str]] = {
        **{f"{side}_{part}": "sampler3D" for side in ("up", "down") for part in ("mean", "low", "high")},
        **dict.fromkeys(("flux", "even", "rest", "glow"), "sampler2D"),
    }
    extra_declarations: ClassVar[tuple[str, ...]] = ("uniform vec3 scattering_peak; // share of the forward peak",)

    kind: Literal["adding_doubling"] = "adding_doubling"
    order: Order = param(
        "all",
        label="Orders",
        help="Which orders of scattering are shown: all, the glow of the forward peak, one, or the rest.",
        source="Belcour 2009, section 4.3",
    )

    def bakes(self, state: Any) -> list[Bake]:
        """The tables of the phase function."""
        return [Bake("doubling", tables.bake_doubling, {}, (state.phase.phase_bake(),), seconds=1)]

    def kept_textures(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, np.ndarray]:
        """Volumes by optical depth, sun and view; pictures by optical depth and sun, or by angle."""
        found = baked["doubling"]
        made = {"flux": found["flux"], "even": found["even"][None], "rest": found["rest"][None], "glow": found["glow"]}
        for side in ("up", "down"):
            made[f"{side}_mean"] = found[side]
            made[f"{side}_low"], made[f"{side}_high"] = found[f"{side}_turns"]
        return made

    def constants(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, Any]:
        """Share of the peak in each band."""
        return {"scattering_peak": tuple(float(share) for share in baked["doubling"]["peak"])}

    def model(self, baked: Mapping[str, Arrays]) -> DoublingModel:
        """The same from the same tables, in float64."""
        return DoublingModel(baked["phase"], baked["doubling"])


class DoublingModel:
    """The twin of `adding_doubling.glsl`, all orders together."""

    def __init__(self, phase: Arrays, doubling: Arrays) -> None:
        self._phase = phase
        self._tables = doubling
        self._peak = doubling["peak"].astype(np.float64)

    def up(self, slab: Slab) -> np.ndarray:
        """See `SlabModel.up`."""
        kept = 1 - self._peak
        scaled = np.stack([first_up(slab, share) / share for share in kept], axis=-1)
        share = tables.second_share(slab.optical_depth, slab.mu_view, slab.mu_sun)
        return self._more(slab, "up") * share[..., None] + look_up(self._phase["value"], slab.cosine) * scaled

    def down(self, slab: Slab) -> np.ndarray:
        """See `SlabModel.down`."""
        kept = 1 - self._peak
        once = first_down(slab)[..., None]
        scaled = np.stack([first_down(slab, share) / share for share in kept], axis=-1)
        share = tables.down_share(slab.optical_depth, slab.mu_view, slab.mu_sun)
        rest = look_up(self._tables["rest"], slab.cosine) * (scaled - once)
        single = look_up(self._phase["value"], slab.cosine) * once
        return np.maximum(self._more(slab, "down") * share[..., None] + rest + single + self._glow(slab), 0)

    def reflectance(self, depth: np.ndarray, mu: np.ndarray) -> np.ndarray:
        """See `SlabModel.reflectance`."""
        depth, mu = np.broadcast_arrays(np.asarray(depth, np.float64), np.asarray(mu, np.float64))
        table = axes.look_up(self._tables["flux"], axes.depth_place(depth), axes.cosine_place(mu))
        return table * tables.plain_reflectance(depth, mu)[..., None]

    def transmittance(self, depth: np.ndarray, mu: np.ndarray) -> np.ndarray:
        """See `SlabModel.transmittance`."""
        return 1 - self.reflectance(depth, mu)

    def diffuse_reflectance(self, depth: np.ndarray) -> np.ndarray:
        """See `SlabModel.diffuse_reflectance`."""
        depth = np.asarray(depth, np.float64)
        return axes.look_up(self._tables["even"], axes.depth_place(depth)) * tables.even_plain(depth)[..., None]

    direct = staticmethod(direct)

    def _more(self, slab: Slab, side: str) -> np.ndarray:
        """Light of two orders and more, over its share of thin layers and grazing directions."""
        places = (axes.depth_place(slab.optical_depth), axes.cosine_place(slab.mu_sun), axes.cosine_place(slab.mu_view))
        turns = np.cos(np.arange(1, 9) * np.arccos(np.clip(slab.cos_azimuth, -1, 1))[..., None])
        low, high = (axes.look_up(table, *places) for table in self._tables[f"{side}_turns"])
        turned = (low * turns[..., :4]).sum(axis=-1) + (high * turns[..., 4:]).sum(axis=-1)
        return np.maximum(axes.look_up(self._tables[side], *places) + turned[..., None], 0)

    def _glow(self, slab: Slab) -> np.ndarray:
        """Two deflections and more by the peak alone."""
        path = slab.optical_depth / np.sqrt(slab.mu_sun * slab.mu_view)
        step = (tables.GLOW_PATHS - 1) / (tables.GLOW_MOST - tables.GLOW_LEAST)
        row = np.clip((np.log2(np.maximum(path, 1e-6)) - tables.GLOW_LEAST) * step, 0, tables.GLOW_PATHS - 1)
        column = np.minimum(table_place(slab.cosine, 2 * tables.GLOW_ANGLES), tables.GLOW_ANGLES - 1)
        shape = axes.look_up(self._tables["glow"], row, column)
        path = np.minimum(path, 80.0)[..., None]
        energy = np.exp(-path) * tables.twice_or_more(self._peak * path)
        return np.where(slab.cosine[..., None] > 0, shape * energy, 0.0)
