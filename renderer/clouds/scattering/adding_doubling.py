"""The accurate technique: every order of scattering by doubling, tabulated, with order 1 exact."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

import numpy as np

from renderer.clouds import peak
from renderer.clouds import slab_axes as axes
from renderer.clouds import slab_tables as tables
from renderer.clouds.phase_tables import look_up, table_place
from renderer.clouds.slab import Slab, direct, first_down, first_up
from renderer.clouds.technique import ScatteringTechnique, padded
from renderer.core.params import param
from renderer.core.technique import Arrays, Bake

Order = Literal["all", "forward", "single", "rest"]


class AddingDoubling(ScatteringTechnique):
    """The layer's true answer to a beam, read from tables."""

    title: ClassVar[str] = "Adding and doubling"
    caption: ClassVar[str] = "All orders of scattering by the true phase function, computed once and tabulated."
    paper: ClassVar[str] = "van de Hulst 1963; Hansen 1971; Wiscombe 1977; Nakajima & Tanaka 1988"
    textures: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("mean", "low", "high"), "sampler3D"),
        **dict.fromkeys(("flux", "even", "glow"), "sampler2D"),
    }
    extra_declarations: ClassVar[tuple[str, ...]] = ("uniform vec3 scattering_peak; // share of the forward peak",)

    kind: Literal["adding_doubling"] = "adding_doubling"
    order: Order = param(
        "all",
        label="Orders",
        help="Which orders of scattering are shown: all, the glow of the forward peak, one, or the rest.",
        cost="build",
        source="Belcour 2009, section 4.3",
    )

    def bakes(self, state: Any) -> list[Bake]:
        """The tables of the phase function."""
        return [Bake("doubling", tables.bake_doubling, {}, (state.phase.phase_bake(),), version=3, seconds=1)]

    def kept_textures(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, np.ndarray]:
        """Volumes by optical depth (the two sides one above the other), sun and view; pictures by optical depth and
        sun, or by path and angle."""
        found = baked["doubling"]
        turns = {name: np.concatenate(list(found[name])) for name in ("low", "high")}
        bands = {"mean": np.concatenate(list(found["mean"])), "flux": found["flux"], "even": found["even"][None],
                 "glow": found["glow"]}
        return {**turns, **{name: padded(array) for name, array in bands.items()}}

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
        scaled = np.stack([first_up(slab, share) / share for share in 1 - self._peak], axis=-1)
        share = tables.second_share(slab.optical_depth, slab.mu_view, slab.mu_sun)
        blurred = look_up(self._phase["value"], slab.cosine) * scaled * self._factor(slab, up=True)
        return self._more(slab, 0) * share[..., None] + blurred

    def down(self, slab: Slab) -> np.ndarray:
        """See `SlabModel.down`."""
        scaled = np.stack([first_down(slab, share) / share for share in 1 - self._peak], axis=-1)
        share = tables.down_share(slab.optical_depth, slab.mu_view, slab.mu_sun)
        around = look_up(self._phase["value"], slab.cosine) * scaled * self._factor(slab, up=False)
        return self._more(slab, 1) * share[..., None] + around

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

    def _more(self, slab: Slab, side: int) -> np.ndarray:
        """Light of two orders and more, over its share of thin layers and grazing directions."""
        places = (axes.depth_place(slab.optical_depth), axes.cosine_place(slab.mu_sun), axes.cosine_place(slab.mu_view))
        turns = np.cos(np.arange(1, 9) * np.arccos(np.clip(slab.cos_azimuth, -1, 1))[..., None])
        low, high = (axes.look_up(self._tables[name][side], *places) for name in ("low", "high"))
        turned = (low * turns[..., :4]).sum(axis=-1) + (high * turns[..., 4:]).sum(axis=-1)
        return np.maximum(axes.look_up(self._tables["mean"][side], *places) + turned[..., None], 0)

    def _factor(self, slab: Slab, up: bool) -> np.ndarray:
        """What the forward peak makes of order 1: a glow around the sun, or a blur behind."""
        if up:
            path = slab.optical_depth * (1 / slab.mu_sun + 1 / slab.mu_view)
        else:
            path = slab.optical_depth / np.sqrt(slab.mu_sun * slab.mu_view)
        step = (peak.PATHS - 1) / (peak.MOST - peak.LEAST)
        row = np.clip((np.log2(np.maximum(path, 1e-6)) - peak.LEAST) * step, 0, peak.PATHS - 1)
        factor = axes.look_up(self._tables["glow"], row, table_place(slab.cosine))
        behind = slab.cosine <= 0
        return np.where((behind == up)[..., None], factor, 1.0)
