"""Light in the shells' truth: closed forms of one scattering, of faces and of shadows, and the error that it states."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from renderer.core.work import Cancelled
from renderer.reference.shells import Options, render
from renderer.reference.shells_world import ShellsWorld, Surface
from tests.reference.shells import CENTRE, alpha, beams, slab, volume, volume_camera

E_SUN, E_SKY = (3.0, 2.0, 1.0), (0.3, 0.4, 0.5)
DOWN = (0.0, 0.0, -1.0)
MIDDLE = (0.4, 0.7, 3.0)


def sun(*towards: float) -> tuple[float, float, float]:
    x, y, z = np.array(towards) / np.linalg.norm(towards)
    return float(x), float(y), float(z)


def wide(sigma: float, colour: tuple[float, float, float] = (0.8, 0.5, 0.2), **changes: object) -> ShellsWorld:
    """An even slab of half a metre, as good as endless, under a sun on the left."""
    given = {"light": "lambert", "sun": sun(-0.6, 0.0, 0.8), "e_sun": E_SUN, **changes}
    return slab([*colour, alpha(sigma, 0.1)], 0.1, sides=(200.0, 200.0, 0.5), origin=(-100.0, -100.0, 0.0), **given)


def lit(world: ShellsWorld, origin: object = MIDDLE, direction: object = DOWN, **options: int) -> np.ndarray:
    return render(world, beams(origin, direction), CENTRE, Options(**options)).radiance[0]


def floor(height: float, albedo: float = 0.4, side: float = 100.0, **changes: object) -> Surface:
    a, b, c, d = ((x * side, y * side, height) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1)))
    return Surface(np.array([[a, b, c], [a, c, d]]), np.full((2, 3, 3), albedo), **changes)


@pytest.mark.parametrize("interpolation", ["nearest", "straight", "extinction"])
def test_one_scattering_in_an_even_slab(interpolation: str) -> None:
    """E/(4 pi) c mu/(1 + mu) (1 - exp(-tau (1 + 1/mu))) for a view along the normal; the sky adds half of its own."""
    tau, mu = 1.5, 0.8
    world = wide(2 * tau, e_sky=E_SKY, interpolation=interpolation)
    once = np.array(E_SUN) / 4 * mu / (1 + mu) * -math.expm1(-tau * (1 + 1 / mu))
    right = np.array([0.8, 0.5, 0.2]) / math.pi * (once + 0.5 * np.array(E_SKY) * -math.expm1(-tau))
    found = render(world, beams(np.tile(MIDDLE, (64, 1)), DOWN), CENTRE, Options(sun_rays=256))
    assert found.radiance[0, :, :3].mean(axis=0) == pytest.approx(right, rel=5e-4)
    assert found.radiance[0, :, 3] == pytest.approx(-math.expm1(-tau))
    error = found.radiance[0, :, :3].mean(axis=1) - right.mean()
    assert 0.3 < np.sqrt(np.mean(error**2)) / found.standard_error[0].mean() < 2


def test_normals_turn_with_the_shell() -> None:
    """A leaning slab of other sides than its texture's: a covector, not a vector."""
    size, lean = np.array([2.0, 1.0, 0.5]), (0.7, -0.3)
    own = np.array([0.48, -0.6, 0.64])
    normal = np.array([*own, 0.0]).reshape(1, 1, 1, 4)
    world = slab([1, 1, 1, 1.0], 0.01, sides=size, lean=lean, light="lambert", sun=sun(0.2, -0.4, 1), e_sun=E_SUN,
                 e_sky=E_SKY, normal=normal)  # fmt: skip
    shear = np.eye(3)
    shear[:2, 2] = np.array(lean) / size[2]
    turned = np.linalg.inv(shear).T @ own
    turned /= np.linalg.norm(turned)
    shone = (np.array(E_SUN) * max(turned @ world.sun, 0) + np.array(E_SKY) * (1 + turned[2]) / 2) / math.pi
    found = lit(world, (1.2, 0.4, 3.0))
    # a view and a sun that go equally deep share the light: cos(view) / (cos(view) + cos(sun)) of the sun's arrives
    share = world.sun[2] / (1 + world.sun[2])
    sky = np.array(E_SKY) * (1 + turned[2]) / 2 / math.pi
    assert found[0, :3] == pytest.approx(share * (shone - sky) + sky, rel=0.03)
    assert abs(max(own @ world.sun, 0) / (turned @ world.sun) - 1) > 0.1, "an unturned one would be seen"


def test_half_a_normal_scatters_half_evenly() -> None:
    normal = np.array([0.0, 0.0, 0.5, 0.0]).reshape(1, 1, 1, 4)
    world = wide(0.001, normal=normal, e_sky=E_SKY, sun=(0.0, 0.0, 1.0))
    found, through = lit(world)[0], alpha(0.001, 0.5)
    right = np.array([0.8, 0.5, 0.2]) / math.pi * (np.array(E_SUN) * (0.5 + 0.5 / 4) + np.array(E_SKY) * 0.75)
    assert found[:3] / through == pytest.approx(right, rel=1e-3)


def test_glow_needs_no_light() -> None:
    normal = np.array([0.0, 0.0, 0.0, 0.3]).reshape(1, 1, 1, 4)
    world = wide(2.0, normal=normal, e_sun=(0, 0, 0), glow_radiance=(1.0, 2.0, 4.0))
    assert lit(world)[0, :3] == pytest.approx(0.3 * alpha(2.0, 0.5) * np.array([0.8, 1.0, 0.8]))
    unlit = dataclasses.replace(world, light="unlit", level=0.5)
    assert lit(unlit)[0, :3] == pytest.approx(alpha(2.0, 0.5) * np.array([0.8, 0.5, 0.2]) * [0.8, 1.1, 1.7])


def test_a_floor_is_seen_and_lit_through_the_shell() -> None:
    tau, mu = 0.6, 0.8
    world = wide(2 * tau, (0.0, 0.0, 0.0), surfaces=(floor(-1.0),), e_sky=E_SKY)
    shone = np.array(E_SUN) * mu * math.exp(-tau / mu) + np.array(E_SKY)
    assert lit(world)[0] == pytest.approx([*(0.4 / math.pi * shone * math.exp(-tau)), 1.0])
    assert lit(dataclasses.replace(world, surfaces=(floor(0.25),)))[0, 0] == pytest.approx(
        0.4 / math.pi * (3 * mu * math.exp(-0.5 * tau / mu) + 0.3) * math.exp(-0.5 * tau)
    ), "a floor inside the shell"
    unlit = dataclasses.replace(world, light="unlit")
    assert lit(unlit)[0, :3] == pytest.approx(0.4 * math.exp(-tau))


def test_a_roof_takes_the_sun_away() -> None:
    world = wide(3.0, e_sky=E_SKY)
    roof = dataclasses.replace(world, surfaces=(floor(5.0, side=50.0),))
    sky = np.array([0.8, 0.5, 0.2]) / math.pi * 0.5 * np.array(E_SKY) * alpha(3.0, 0.5)
    assert lit(roof)[0, :3] == pytest.approx(sky), "the sky's light is not shadowed, by its definition"
    assert lit(world)[0, 0] > 1.3 * sky[0]
    unshadowed = lit(dataclasses.replace(roof, shadows=False))[0, :3]
    right = np.array([0.8, 0.5, 0.2]) / math.pi * 0.25 * np.array(E_SUN) * alpha(3.0, 0.5)
    assert unshadowed == pytest.approx(sky + right, rel=1e-6), "by the shell itself, too"
    aside = Surface(roof.surfaces[0].corners + [150.0, 0, 0], roof.surfaces[0].albedo)
    assert lit(dataclasses.replace(world, surfaces=(aside,))) == pytest.approx(lit(world))


def test_a_face_has_smooth_normals_its_own_side_and_a_picture() -> None:
    rng = np.random.default_rng(3)
    normals = rng.normal(size=(2, 3, 3)) * 0.1 + [0, 0, 1]
    picture = rng.random((2, 4, 3))
    corners = floor(0.0, side=1.0).corners
    surface = floor(0.0, 1.0, 1.0, normals=normals, uv=(corners[..., :2] + 1) / 2, picture=picture)
    world = dataclasses.replace(wide(0.0), surfaces=(surface,), e_sky=E_SKY)
    found = lit(world, (0.25, -0.75, 3.0))[0]
    weights = np.array([0.375, 0.5, 0.125])  # of the first face, at (0.25, -0.75)
    normal = weights @ normals[0]
    normal /= np.linalg.norm(normal)
    u, v = 0.625 * 4 - 0.5, 0.125 * 2 - 0.5
    assert (u, v) == (2.0, -0.25)
    texel = 0.75 * picture[0, 2] + 0.25 * picture[1, 2]
    shone = np.array(E_SUN) * (normal @ world.sun) + np.array(E_SKY) * (1 + normal[2]) / 2
    assert found[:3] == pytest.approx(texel / math.pi * shone)
    below = lit(world, (0.25, -0.75, -3.0), (0, 0, 1))[0]
    assert below[:3] == pytest.approx(texel / math.pi * np.array(E_SKY) * (1 - normal[2]) / 2), "no sun from beneath"


@pytest.fixture(scope="module")
def clouded() -> ShellsWorld:
    rgba = volume()[::2, ::2, ::2]
    normal = np.zeros_like(rgba)
    normal[..., 2] = 0.5
    return slab(rgba, 1 / 64, light="lambert", sun=sun(0.4, 0.3, 0.8), e_sun=E_SUN, e_sky=E_SKY, normal=normal,
                interpolation="extinction", surfaces=(floor(-0.1, side=3.0),))  # fmt: skip


def test_the_error_is_as_stated(clouded: ShellsWorld) -> None:
    """Two seeds against their own word; a picture of few rays to the sun against one of many."""
    looking = volume_camera(*np.mgrid[8:128:6, 8:128:6])
    first, second = (render(clouded, looking, CENTRE, Options(sun_rays=8, seed=s)) for s in (1, 2))
    fine = render(clouded, looking, CENTRE, Options(sun_rays=128))
    apart = np.sqrt(np.mean((first.radiance - second.radiance)[..., :3].mean(axis=-1) ** 2) / 2)
    said = np.sqrt(np.mean(first.standard_error**2))
    assert 0.3 < apart / said < 1.5
    assert np.array_equal(first.radiance[..., 3], second.radiance[..., 3])
    off = np.sqrt(np.mean((first.radiance - fine.radiance)[..., :3].mean(axis=-1) ** 2))
    assert 0.3 < off / said < 1.5
    assert fine.relative_error < 0.3 * first.relative_error


def test_threads_change_nothing_and_a_wish_to_stop_is_heard(clouded: ShellsWorld) -> None:
    looking = volume_camera(*np.mgrid[0:128:16, 0:128:16])
    told: list[float] = []
    one = render(clouded, looking, CENTRE, Options(threads=1), lambda share, words: told.append(share))
    assert told == [0.5, 1.0]
    assert np.array_equal(one.radiance, render(clouded, looking, CENTRE, Options(threads=3)).radiance)

    def stop(share: float, words: str) -> None:
        raise Cancelled

    with pytest.raises(Cancelled):
        render(clouded, looking, CENTRE, progress=stop)
