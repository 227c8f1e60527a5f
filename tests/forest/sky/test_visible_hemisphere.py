"""Sky light by the visible hemisphere: integrals of a linear visibility over a sky, and the reference's rays to it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.forest.sky.visible_hemisphere import VisibleHemisphere
from renderer.world.sky_picture import MOMENTS
from tests.forest.truth import MARCH, Judge

Ask = Callable[..., np.ndarray]
FILE = "forest/sky/visible_hemisphere.glsl"
SPOT = "sky_light(Spot(vec3(0.0), vec3(0.3, 0.4, 0.5), 0.0, wooded, 0.0))"
SUN = np.array([0.6, -0.64, 0.48])
"""Towards the sun; its level part is not along an axis."""

OPEN = (1.0, 0.5, 0.5, 1.0)


def hemisphere() -> tuple[np.ndarray, np.ndarray]:
    """Directions (M, 3) spread evenly over the upper hemisphere, and the solid angle of each."""
    up, azimuth = np.meshgrid((np.arange(200) + 0.5) / 200, (np.arange(240) + 0.5) / 240 * 2 * np.pi)
    level = np.sqrt(1 - up**2)
    rays = np.stack([level * np.sin(azimuth), level * np.cos(azimuth), up], axis=-1).reshape(-1, 3)
    return rays, np.full(len(rays), 2 * np.pi / len(rays))


RAYS, ANGLES = hemisphere()
LIGHT = np.stack([1 + 0 * RAYS[:, 0], 2 * RAYS[:, 2], np.exp(2 * RAYS @ SUN)], axis=1)
"""Radiance of a made-up sky: even, bright above, and bright around the sun."""


def moments() -> dict[str, np.ndarray]:
    """The sky's moments by their definition."""
    s = SUN[:2] / np.linalg.norm(SUN[:2])
    sunward, across = RAYS[:, :2] @ s, RAYS[:, :2] @ np.array([-s[1], s[0]])
    up = RAYS[:, 2]
    parts = {"sky_even": up**0, "sky_upward": up, "sky_sunward": sunward, "sky_upward2": up**2,
             "sky_sunward2": sunward**2, "sky_across2": across**2, "sky_upward_sunward": up * sunward}
    assert set(parts) == set(MOMENTS)
    return {name: (ANGLES[:, None] * part[:, None] * LIGHT).sum(axis=0) for name, part in parts.items()}


def asked(ask: Ask, what: str, trees: tuple, land: tuple = OPEN, wooded: float = 1.0) -> np.ndarray:
    """A value of the sky's light (3,) at a place whose texels are given."""
    made = {"sky_seen": np.rint(255 * np.broadcast_to(np.array(trees), (2, 2, 2, 4))).astype(np.uint8),
            "sky_land": np.broadcast_to(land, (4, 4, 4))}
    values = {**moments(), "sky_sun_direction": tuple(SUN)}
    found: np.ndarray = ask(["forest/matter.glsl", FILE], what, {"wooded": np.array([wooded])}, 3,
                            techniques={"sky": VisibleHemisphere()}, textures=made, values=values,
                            declarations="uniform vec3 sky_sun_direction;")
    return found[0]


TREES = (120 / 255, 150 / 255, 100 / 255, 160 / 255)
NORMALS = ("vec3(0.0, 0.0, 1.0)", "vec3(1.0, 0.0, 0.0)", "vec3(0.0, 1.0, 0.0)")


def seen(trees: tuple) -> np.ndarray:
    """Visibility along `RAYS`: linear in the direction, with the texel's integrals."""
    mean, x, y, up = trees[0], 2 * trees[1] - 1, 2 * trees[2] - 1, trees[3]
    linear: np.ndarray = RAYS @ np.array([1.5 * x, 1.5 * y, 6 * (up - mean)]) + 4 * mean - 3 * up
    return linear


def error(ask: Ask) -> float:
    """Greatest relative error of the light around and towards each axis, against sums over the hemisphere."""
    weight = (ANGLES * seen(TREES))[:, None] * LIGHT
    found = [2 * asked(ask, SPOT + ".around", TREES)]
    found += [asked(ask, f"{SPOT}.towards * {normal}", TREES) for normal in NORMALS]
    exact = [weight.sum(axis=0), *((weight * RAYS[:, k : k + 1]).sum(axis=0) for k in (2, 0, 1))]
    return float(np.abs(np.array(found) - exact).max() / np.abs(exact).max())


def test_the_texel_holds_integrals_of_the_visibility() -> None:
    linear = seen(TREES) * ANGLES / np.pi
    assert linear.sum() / 2 == pytest.approx(TREES[0], rel=1e-4)
    assert linear @ RAYS == pytest.approx([2 * TREES[1] - 1, 2 * TREES[2] - 1, TREES[3]], rel=1e-3)


def test_light_is_the_integral_over_the_hemisphere(ask: Ask) -> None:
    assert error(ask) < 2e-4


@pytest.mark.parametrize(("right", "wrong"), [
    ("vec2 t = vec2(-s.y, s.x)", "vec2 t = vec2(s.y, s.x)"),
    ("float c = 4.0 * trees.x - 3.0 * trees.w", "float c = trees.x"),
    ("vec2 level = 1.5 *", "vec2 level = -1.5 *"),
    ("c * upward + up * upward2 + level.x * aslant", "c * upward + up * upward2"),
    ("Skylight(0.5 * whole", "Skylight(whole"),
])
def test_a_wrong_integral_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil(FILE, right, wrong):
        assert error(ask) > 0.02


def test_open_ground_takes_the_whole_sky(ask: Ask) -> None:
    light = f"sky_on_ground(vec3(1.0), vec3(0.0, 0.0, 1.0), {SPOT})"
    found = asked(ask, light, (0, 0, 0, 0), wooded=0.0)
    assert found[0] == pytest.approx(np.pi, rel=1e-3)
    assert found == pytest.approx(moments()["sky_upward"], rel=3e-3), "all that comes down"


def ground_error(ask: Ask) -> float:
    """Greatest relative error of what comes down on open ground, of which the land hides one side, against the sum."""
    found = asked(ask, f"sky_on_ground(vec3(1.0), vec3(0.0, 0.0, 1.0), {SPOT})", (0, 0, 0, 0), TREES, 0.0)
    exact = ((ANGLES * seen(TREES) * RAYS[:, 2])[:, None] * LIGHT).sum(axis=0)
    return float(np.abs(found / exact - 1).max())


def test_ground_knows_which_side_of_the_sky_the_land_hides(ask: Ask) -> None:
    assert ground_error(ask) < 1e-3


@pytest.mark.parametrize(("right", "wrong"), [
    ("1.5 * open.x * sky_upward_sunward", "0.0 * sky_upward_sunward"),
    ("high * sky_upward2", "0.0 * sky_upward2"),
    ("mix(max(hides, 0.0), upward, spot.wooded)", "mix(upward, max(hides, 0.0), spot.wooded)"),
])
def test_ground_that_takes_its_share_of_an_even_sky_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil(FILE, right, wrong):
        assert ground_error(ask) > 0.02


@pytest.mark.parametrize("sine", [0.2, 0.6])
def test_an_even_horizon_takes_what_lies_below_it(ask: Ask, sine: float) -> None:
    """Closed form: under an even sky, level ground behind a horizon of sine x all round gets 1 - x^2."""
    land = (1 - sine, 0.5, 0.5, 1 - sine**2)
    assert asked(ask, SPOT + ".around", OPEN, land)[0] == pytest.approx(np.pi * (1 - sine), rel=3e-3)
    up = asked(ask, f"{SPOT}.towards * vec3(0.0, 0.0, 1.0)", OPEN, land)
    assert up[0] == pytest.approx(np.pi * (1 - sine**2), rel=3e-3)


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds(
        "sky", "visible_hemisphere",
        MARCH,
        0.03,  # visibility linear in the direction, in voxels of twice the length; and 0.022 of the reference's noise
        against="sky",
    )


def test_a_sky_that_no_tree_hides_is_found(judge: Judge, spoil: Callable) -> None:
    with spoil(FILE, "trees.yz = trees.yz * 2.0 - 1.0;", "trees = vec4(1.0, 0.0, 0.0, 1.0);"):
        assert judge.distance("sky", "visible_hemisphere", "sky") > 2 * (MARCH + 0.03)


def test_picture(judge: Judge) -> None:
    judge.looks("sky", "visible_hemisphere")
