"""Horizon volume: its lookup between heights and round the tile, its slope, its distance to the truth."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.forest.horizon_textures import stacked_at
from renderer.forest.shadow.horizon_volume import HorizonVolume
from renderer.forest.soft_horizon import GAMMA_RANGE, SPREAD_RANGE
from renderer.forest.world_scale import CELL, NODES
from tests.forest import worlds
from tests.forest.horizons import CALL, LAND_SOFTNESS, threshold
from tests.forest.truth import MARCH, Judge

Ask = Callable[..., np.ndarray]
FILE = "forest/shadow/horizon_volume.glsl"
MADE = HorizonVolume(levels=4, highest=0.8)
RNG = np.random.default_rng(3)
BYTES = RNG.integers(0, 256, (1, 4, 8, 6, 3), np.uint8)
"""One sector, (heights, J, I) = (4, 8, 6): gamma, spread and clear share."""

COUNT = 400
UV, H = RNG.uniform(-1, 2, (COUNT, 2)), RNG.uniform(0, 1, COUNT)


def interpolated(plane: np.ndarray, uv: np.ndarray) -> np.ndarray:
    """Twin of a fetch in float64: bilinear and periodic over the tile, (N, 3)."""
    rows, columns, _ = plane.shape
    found = np.zeros((len(uv), 3))
    i, j = uv[:, 0] * columns - 0.5, uv[:, 1] * rows - 0.5
    low_i, low_j = np.floor(i), np.floor(j)
    for dj, di in np.ndindex(2, 2):
        weight = (j - low_j if dj else 1 - j + low_j) * (i - low_i if di else 1 - i + low_i)
        found += weight[:, None] * plane[((low_j + dj) % rows).astype(int), ((low_i + di) % columns).astype(int)]
    return found / 255


def lit(ask: Ask, made: HorizonVolume, elevation: float, *, land: float = 0.0, cover: float = 1.0,
        rise: float = 0.0, azimuth: float = 90.0) -> np.ndarray:
    """Share of the sun at (UV, H); land's horizon in degrees, `rise` of the ground to the east."""
    height = rise * (np.arange(NODES) - (NODES - 1) / 2) * CELL
    terrain = worlds.ground(np.broadcast_to(height - height.min(), (NODES, NODES)), cover)
    textures = {"shadow_terrain": np.full((2, 2), np.radians(land)), "shadow_canopy": stacked_at(BYTES, 0.0) / 255}
    inputs = {"position": np.tile([10.0, 20.0, 0.0], (COUNT, 1)), "h": H, "uv": UV}
    return ask([FILE], CALL, inputs, 1, techniques={"shadow": made}, textures=textures, terrain=terrain,
               state=worlds.state(sun=worlds.sun(azimuth, elevation)))[:, 0].astype(float)


def twin(made: HorizonVolume, phi: float, over_ground: float) -> np.ndarray:
    """The technique without land, phi the sun's elevation over the horizontal and over the ground [rad]."""
    place = np.clip(H / made.highest, 0, 1) * (made.levels - 1)
    seen = []
    for plane in BYTES[0]:
        found = interpolated(plane, UV)
        gamma, spread = (found[:, n] * (high - low) + low for n, (low, high) in enumerate((GAMMA_RANGE, SPREAD_RANGE)))
        t = np.clip((over_ground - gamma + spread) / (2 * spread), 0, 1)
        seen.append(found[:, 2] * t * t * (3 - 2 * t))
    below = np.minimum(place.astype(int), made.levels - 2)
    lower, upper = (np.array(seen)[below + n, np.arange(COUNT)] for n in (0, 1))
    shown = 1 - made.strength + made.strength * (lower + (place - below) * (upper - lower))
    return shown * threshold(np.zeros(()), np.array(phi), LAND_SOFTNESS)


def worst(ask: Ask) -> float:
    """Largest error against the twin, over suns, on level ground and on a slope."""
    found = 0.0
    suns = ((3, 0, 0), (20, 0, 50), (45, 0.3, 90), (30, 0.3, 270), (25, -0.5, 140), (80, 1, 0))
    for elevation, rise, azimuth in suns:
        phi = np.radians(elevation)
        over = np.arctan(np.tan(phi) - rise * np.sin(np.radians(azimuth)))
        seen = lit(ask, MADE, elevation, rise=rise, azimuth=azimuth)
        found = max(found, float(np.abs(seen - twin(MADE, phi, over)).max()))
    return found


def test_the_lookup_is_the_twins(ask: Ask) -> None:
    """Budget: normals are kept in 16 bits, and a byte's 0.35 degrees of penumbra are steep."""
    assert worst(ask) < 0.004


@pytest.mark.parametrize(("right", "wrong"), [
    ("soft_horizon(uv, lowest + level + 1.0, phi), place", "soft_horizon(uv, lowest + level, phi), place"),
    ("level * rows + 1.0 +", "level * rows +"),
    ("fract(uv.y)", "uv.y"),
    ("phi = sun_over_ground(position.xy)", "phi = sun_elevation"),
    ("clamp(h / shadow_highest, 0.0, 1.0)", "h"),
    ("return found.b *", "return"),
])
def test_a_wrong_lookup_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil(FILE, right, wrong):
        assert worst(ask) > 0.02


def test_the_land_hides_all_and_the_canopy_its_share(ask: Ask) -> None:
    assert (lit(ask, MADE, 20, land=40) == 0).all()
    half = HorizonVolume(levels=4, highest=0.8, strength=0.5)
    full = lit(ask, MADE, 20)
    np.testing.assert_allclose(lit(ask, half, 20), 0.5 + 0.5 * full, atol=1e-5)


def test_a_glade_knows_no_tile(ask: Ask) -> None:
    assert (lit(ask, MADE, 20, cover=0.0) == 1).all()
    assert (lit(ask, MADE, 20, cover=1.0) < 0.5).any()


def test_light_grows_with_the_sun_and_none_comes_from_below(ask: Ask) -> None:
    shares = np.array([lit(ask, MADE, elevation) for elevation in (-1, 3, 10, 20, 40, 60, 85)])
    assert (np.diff(shares, axis=0) >= -1e-6).all()
    assert (shares[0] == 0).all()
    assert ((shares >= 0) & (shares <= 1)).all()


def test_the_textures_turn_with_the_sun_and_not_with_its_height() -> None:
    made = HorizonVolume(sectors=8, levels=2)
    keys = [made.frame_key(worlds.state(sun=worlds.sun(*sun))) for sun in ((80, 20), (80, 40), (81, 20))]
    assert keys[0] == keys[1] != keys[2]
    soft = np.zeros((8, 2, 4, 4, 3), np.uint8)
    soft[2, ..., 0] = 200
    bakes = {"terrain_horizon": {"sectors": np.zeros((8, 2, 2), np.float32)}, "soft_horizon": {"soft": soft}}
    for azimuth, exact in ((90, 200), (67.5, 100), (112.5, 100), (45, 0), (200, 0)):
        found = made.frame_textures(worlds.state(sun=worlds.sun(azimuth, 20)), bakes)["canopy"]
        assert np.abs(found[..., 0].astype(int) - exact).max() <= 1
        assert (found[..., 1:] == 0).all()


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds(
        "shadow", "horizon_volume",
        MARCH,
        0.35,  # the glade's edge in cells of 8 m, which hides all light; the neighbours are the atlas' own
        against="full",
    )


def test_no_shadow_is_farther_from_the_truth(judge: Judge) -> None:
    assert judge.distance("shadow", "none", "full") > 1.5 * (MARCH + 0.35)


def test_picture(judge: Judge) -> None:
    judge.looks("shadow", "horizon_volume")
