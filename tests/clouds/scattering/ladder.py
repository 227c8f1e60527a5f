"""What every scattering technique is held to: its twin, its energy, and values of an independent solver.

DISORT's values are copied from `a_slab.npz` of the shared reference folder (PythonicDISORT 1.8, 384 streams for Mie):
droplets of 10 um, normal, 1 % wide, at 650 nm; nothing absorbed, black ground.
"""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace

import numpy as np

from renderer.clouds.phase.mie import Mie
from renderer.clouds.slab import Slab
from renderer.clouds.technique import ScatteringTechnique

Ask = Callable[..., np.ndarray]
Baked = Callable[..., dict[str, np.ndarray]]

PHASE = Mie(width=0.01, sun_disc=False)
SLAB = "Slab(p.x, p.y, p.z, q.x, q.y)"

DEPTHS = np.array([0.5, 2.0, 8.0, 32.0, 128.0])
SUNS = np.array([1.0, 0.7, 0.4, 0.1])
REFLECTANCE = np.array([
    [0.02025, 0.04219, 0.11882, 0.43955],
    [0.08788, 0.16705, 0.33237, 0.60105],
    [0.33961, 0.45853, 0.59397, 0.75369],
    [0.71281, 0.76763, 0.82607, 0.89442],
    [0.91235, 0.92908, 0.94692, 0.96778],
])
"""By DEPTHS and SUNS; what is not reflected is let through."""

AT_DEPTHS, AT_SUNS, AT_VIEWS = np.array([2.0, 32.0]), np.array([0.7, 0.1]), np.array([0.3, 0.9])
AT_AZIMUTHS = np.radians([15.0, 90.0, 180.0])
UP = np.array([
    [[[0.171375, 0.0545561, 0.0877815], [0.025297, 0.0261527, 0.0374998]],
     [[1.64825, 0.119258, 0.171311], [0.0644335, 0.0308256, 0.0374731]]],
    [[[0.328577, 0.198824, 0.23122], [0.236229, 0.234441, 0.247523]],
     [[1.72785, 0.192096, 0.242779], [0.166057, 0.130641, 0.137373]]],
])
DOWN = np.array([
    [[[0.508348, 0.0854008, 0.0533515], [0.465905, 0.111415, 0.0417395]],
     [[0.509768, 0.0930032, 0.0832424], [0.142009, 0.0562385, 0.0349114]]],
    [[[0.0503542, 0.0503336, 0.0503124], [0.0886717, 0.0886252, 0.0885777]],
     [[0.0228747, 0.0228691, 0.0228633], [0.0402796, 0.0402669, 0.0402539]]],
])
"""Radiance for each unit of irradiance on the level, by depth, sun, view and azimuth."""


def slabs(up: bool, count: int = 4000) -> Slab:
    """Layers and directions at random, rounded as the shader receives them."""
    rng = np.random.default_rng(11)
    depth = 2 ** rng.uniform(-6, 8, count)
    sun, view = rng.uniform(0.03, 1, (2, count))
    azimuth = rng.uniform(0, 2 * np.pi, count)
    made = Slab.between(depth, sun, view, azimuth, up)
    return Slab(*(a.astype(np.float32).astype(np.float64) for a in vars(made).values()))


def arrays(technique: ScatteringTechnique, baked: Baked) -> dict[str, dict[str, np.ndarray]]:
    """What the technique needs baked, by name."""
    bakes = [PHASE.phase_bake(), *technique.bakes(SimpleNamespace(phase=PHASE))]
    return {bake.name: baked(bake) for bake in bakes}


def radiance_error(ask: Ask, baked: Baked, technique: ScatteringTechnique, up: bool) -> float:
    """Greatest difference of GLSL and twin, over the twin and a thousandth of the mean of all."""
    slab = slabs(up)
    model = technique.model(arrays(technique, baked))
    twin = model.up(slab) if up else model.down(slab)
    inputs = {"p": np.stack([slab.optical_depth, slab.mu_sun, slab.mu_view], axis=1),
              "q": np.stack([slab.cosine, slab.cos_azimuth], axis=1)}
    found = ask({"phase": PHASE, "scattering": technique}, f"scattering_{'up' if up else 'down'}({SLAB})", inputs)
    chosen = ask({"phase": PHASE, "scattering": technique}, f"scattering_leaving({SLAB}, {str(up).lower()})", inputs)
    return float((np.maximum(np.abs(found - twin), np.abs(chosen - twin)) / (np.abs(twin) + 1e-3 * twin.mean())).max())


def parts_error(ask: Ask, whole: ScatteringTechnique, orders: tuple[str, ...], up: bool) -> float:
    """Greatest difference between all orders and the sum of those shown alone, over the mean."""
    slab = slabs(up)
    inputs = {"p": np.stack([slab.optical_depth, slab.mu_sun, slab.mu_view], axis=1),
              "q": np.stack([slab.cosine, slab.cos_azimuth], axis=1)}

    def shown(order: str) -> np.ndarray:
        technique = whole.model_copy(update={"order": order})
        return ask({"phase": PHASE, "scattering": technique}, f"scattering_{'up' if up else 'down'}({SLAB})", inputs)

    every = shown("all")
    return float((np.abs(sum(map(shown, orders)) - every) / (every + every.mean())).max())


def flux_error(ask: Ask, baked: Baked, technique: ScatteringTechnique) -> float:
    """Greatest difference of GLSL and twin in what is reflected and let through, of a beam and of even light."""
    slab = slabs(True)
    depth, mu = slab.optical_depth, slab.mu_sun
    model = technique.model(arrays(technique, baked))
    twin = np.concatenate([model.reflectance(depth, mu), model.transmittance(depth, mu),
                           model.diffuse_reflectance(depth), np.repeat(model.direct(depth, mu)[:, None], 3, 1)], axis=1)
    body = "; ".join(f"vec3 {name} = scattering_{call}" for name, call in (
        ("r", "reflectance(p.x, p.y)"), ("t", "transmittance(p.x, p.y)"), ("d", "diffuse_reflectance(p.x)"),
        ("e", "direct(p.x, p.y)")))
    body += "; result = float[12](r.x, r.y, r.z, t.x, t.y, t.z, d.x, d.y, d.z, e.x, e.y, e.z);"
    found = ask({"phase": PHASE, "scattering": technique}, body, {"p": np.stack([depth, mu], axis=1)}, 12)
    return float(np.abs(found - twin).max())


def unbalanced(technique: ScatteringTechnique, baked: Baked) -> float:
    """Greatest distance of reflectance and transmittance together from 1, over depths from 0 to 256."""
    model = technique.model(arrays(technique, baked))
    depth, mu = np.meshgrid(np.concatenate([[0.0], 2.0 ** np.linspace(-8, 8, 33)]), np.linspace(0.01, 1, 25))
    reflected, passed = model.reflectance(depth, mu), model.transmittance(depth, mu)
    assert reflected.min() >= 0
    assert passed.min() >= 0
    return float(np.abs(reflected + passed - 1).max())


def reflectance_off(technique: ScatteringTechnique, baked: Baked) -> np.ndarray:
    """Reflectance over DISORT's, less 1, by DEPTHS and SUNS."""
    model = technique.model(arrays(technique, baked))
    return model.reflectance(DEPTHS[:, None], SUNS)[..., 0] / REFLECTANCE - 1


def radiance_off(technique: ScatteringTechnique, baked: Baked, up: bool) -> np.ndarray:
    """Radiance over DISORT's, less 1, by AT_DEPTHS, AT_SUNS, AT_VIEWS and AT_AZIMUTHS."""
    sun = AT_SUNS[:, None, None]
    slab = Slab.between(AT_DEPTHS[:, None, None, None], sun, AT_VIEWS[:, None], AT_AZIMUTHS, up)
    model = technique.model(arrays(technique, baked))
    return (model.up(slab) if up else model.down(slab))[..., 0] / sun / (UP if up else DOWN) - 1


def leaving(technique: ScatteringTechnique, baked: Baked, depth: float, sun: float) -> tuple[float, float]:
    """Hemispherical flux of the radiances on both sides, over the beam's on the level: a quadrature over directions."""
    model = technique.model(arrays(technique, baked))
    nodes, weights = np.polynomial.legendre.leggauss(120)
    view, azimuth = (nodes[:, None] + 1) / 2, (nodes + 1) * np.pi / 2
    found = []
    for up in (True, False):
        slab = Slab.between(np.array(depth), np.array(sun), view, azimuth, up)
        radiance = (model.up(slab) if up else model.down(slab))[..., 0]
        found.append(float(np.einsum("va,v,a,v->", radiance, weights / 2, weights * np.pi, view[:, 0]) / sun))
    return found[0], found[1]
