"""The reference's light from the sky: closed forms, a second writing in plain numpy, and its own standard error."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import expn

from renderer.core.errors import InputError
from renderer.reference.forest import Options, render
from renderer.reference.forest_sky import sky_ray
from renderer.reference.forest_sky_table import level_irradiance
from renderer.reference.forest_world import ForestWorld, prepare
from tests.reference.test_forest_twin import WORLD, nodes, sample
from tests.reference.worlds import CENTRE, GROUND, flat, looking, unit

DARK = (0.0, 0.0, 0.0)
EVEN = (1.0, 1.5, 2.0)
SKY = Options(sky="hemisphere")
ALPHA = 20
SIGMA = -np.log(1 - ALPHA / 255) / 0.625
DEPTH = SIGMA * 20
CELLS = (16, 32)
BELOW = np.array([[[3.0, 1.0, 500.0]]]), np.array([[[0.0, 0.0, -1.0]]])


def one_cell(row: int, column: int, cells: tuple[int, int] = CELLS) -> tuple[np.ndarray, np.ndarray, float]:
    """A sky of which one cell shines: its table, the direction of its middle, and its solid angle."""
    table = np.zeros((*cells, 3))
    table[row, column] = (1.0, 2.0, 4.0)
    up, azimuth = (row + 0.5) / cells[0], (column + 0.5) / cells[1] * 2 * np.pi
    level = np.sqrt(1 - up**2)
    return table, np.array([level * np.sin(azimuth), level * np.cos(azimuth), up]), 2 * np.pi / (cells[0] * cells[1])


def under(table: np.ndarray | None, alpha: int = 0, **changes: object) -> ForestWorld:
    """A level world under a table of the sky's radiance and no sun; an even sky of `EVEN` where there is none."""
    e_sky = EVEN if table is None else tuple(float(c) for c in level_irradiance(table))
    return flat(alpha, e_sun=DARK, e_sky=e_sky, sky=table, **changes)


def mean(world: ForestWorld, rays: object, samples: int = 16) -> np.ndarray:
    """Radiance (3,) over some pixels, under some ten thousand rays to the sky."""
    found = render(world, rays, np.tile(CENTRE, (samples, 1)), SKY)  # type: ignore[arg-type]
    return np.asarray(found.radiance[..., :3].mean(axis=(0, 1)))


def down(x: float, y: float) -> object:
    """One ray straight down, repeated over a row of pixels, each with its own random numbers."""
    origins = np.broadcast_to([x, y, 500.0], (1, 8, 3))
    return lambda _: (origins, np.broadcast_to([0.0, 0.0, -1.0], origins.shape))


def test_directions_are_drawn_as_bright_as_the_sky_is() -> None:
    table = np.random.default_rng(1).uniform(0, 1, (4, 6, 3)) ** 4
    scene = prepare(under(table))
    u = (np.arange(200) + 0.5) / 200
    drawn = [sky_ray(scene, float(a), float(b)) for a in u for b in u]
    rays, powers = (np.array(part) for part in zip(*drawn, strict=True))
    assert np.linalg.norm(rays, axis=1) == pytest.approx(np.ones(len(rays)))
    # 200 even steps of each number miss the borders of the cells by half a step
    assert (powers * rays[:, 2:]).mean(axis=0) == pytest.approx(level_irradiance(table), rel=1e-2)
    # what comes from the east, by the definition of the columns: the first half of them
    east = 2 * np.pi * table[:, :3].mean(axis=(0, 1)) / 2
    assert (powers * (rays[:, :1] > 0)).mean(axis=0) == pytest.approx(east, rel=1e-2)


def test_open_ground_under_an_even_sky_takes_pi_times_its_radiance() -> None:
    found = mean(under(None, cover=np.zeros((33, 33))), down(3, 1))
    assert found == pytest.approx(np.array(GROUND) / np.pi * EVEN, rel=5e-3)
    assert np.pi * (np.array(EVEN) / np.pi) == pytest.approx(level_irradiance(np.full((8, 8, 3), EVEN) / np.pi))


@pytest.mark.parametrize(("row", "column"), [(2, 5), (14, 20)])
def test_one_cell_of_the_sky_lights_a_slope_by_its_cosine(row: int, column: int) -> None:
    table, towards, angle = one_cell(row, column, (64, 128))
    tilted = np.repeat((np.arange(33) * 8.0 * 0.5)[:, None], 33, axis=1)  # rises to the south, faces north
    world = under(table, elevation=tilted)
    expected = np.array(GROUND) / np.pi * table[row, column] * angle * max(unit((0, 0.5, 1)) @ towards, 0)
    assert mean(world, down(3, 1), 4) == pytest.approx(expected, rel=0.02, abs=1e-9)
    turned = replace(world, sky=np.roll(table, 64, axis=1))
    assert mean(turned, down(3, 1), 4) != pytest.approx(expected, rel=0.2), "a sky turned round is another"


def test_ground_under_a_slab_is_lit_through_it_along_every_direction() -> None:
    found = mean(under(None, ALPHA), lambda _: (np.array([[[3.0, 1.0, 1e-4]]]), BELOW[1]), 256)
    assert found == pytest.approx(np.array(GROUND) / np.pi * EVEN * 2 * expn(3, DEPTH), rel=0.06)


def test_a_slab_of_level_leaves_reflects_above_and_lets_through_below() -> None:
    """Radiance 2 rho L times the integral over the depth t of exp(-t) E3(t), Chandrasekhar 1950, section 8."""
    world = under(None, ALPHA, ground_albedo=DARK, leaf_transmission=(0.9, 0.5, 0.2))
    above = quad(lambda t: np.exp(-t) * expn(3, t), 0, DEPTH)[0]
    radiance = np.array(EVEN) / np.pi
    assert mean(world, down(3, 1)) == pytest.approx(0.5 * 2 * radiance * above, rel=0.015)
    up = lambda _: (np.tile([3.0, 1.0, 1e-3], (1, 8, 1)), np.tile([0.0, 0.0, 1.0], (1, 8, 1)))  # noqa: E731
    below = quad(lambda t: np.exp(-t) * expn(3, DEPTH - t), 0, DEPTH)[0]
    assert mean(world, up) == pytest.approx(0.5 * np.array([0.9, 0.5, 0.2]) * 2 * radiance * below, rel=0.02)


def test_a_trench_hides_the_sky_that_its_walls_cover() -> None:
    """Between endless walls up to the elevation a on both sides, level ground has cos a of the whole irradiance."""
    floor = np.full((65, 65), 40.0)
    floor[31:34] = 0.0  # walls rise from 8 to 16 m off the middle row
    found = mean(under(None, nodes=65, elevation=floor), down(0, 0), 32)
    # the trench ends 256 m away in full height, which hides what lies below 9 degrees along it
    edge = np.arctan2(40, 16)
    exact = np.cos(edge)
    assert found == pytest.approx(np.array(GROUND) / np.pi * EVEN * exact, rel=0.03)


def test_a_furnace_gains_nothing_and_wood_lets_nothing_through() -> None:
    world = under(None, 60, albedo=1.0, ground_albedo=(1.0, 1.0, 1.0))
    bright = mean(world, looking(np.random.default_rng(4).uniform(-50, 50, (8, 2)), (0.3, 0.2, -0.4)), 2)
    assert (bright < np.array(EVEN) / np.pi).all()
    wood = np.array(world.anchor)
    wood[..., 3] = 64 + 128
    up = lambda _: (np.array([[[3.0, 1.0, 1e-3]]]), np.array([[[0.0, 0.0, 1.0]]]))  # noqa: E731
    trunk = replace(world, anchor=wood, leaf_transmission=(1.0, 1.0, 1.0))
    # the stored normal leans by half a byte, so that a low sky reaches a sliver of the underside
    assert mean(trunk, up, 4).max() < 0.02 * max(EVEN) / np.pi


def brute(world: ForestWorld, rays: int, rng: np.random.Generator, turn: int = 0) -> tuple[float, float]:
    """Mean radiance of the grove's leaves under its sky by even steps and chance directions, and its standard error."""
    assert world.sky is not None
    origins, directions = looking(POINTS, VIEW)((0.5, 0.5))
    total, variance, step = 0.0, 0.0, 0.1
    for origin in origins[0]:
        s = np.arange(step / 2, 160, step)
        points = origin + s[:, None] * directions[0, 0]
        under_ground = points[:, 2] < nodes(world.elevation, world.cell, points[:, :2])
        points = points[: int(np.argmax(under_ground)) if under_ground.any() else len(points)]
        sigma, atlas, tint = sample(world, points)
        depth = np.concatenate([[0], np.cumsum(sigma * step)])
        weight = np.exp(-depth[:-1]) - np.exp(-depth[1:])
        if weight.sum() < 1e-6:
            continue
        chosen = rng.choice(len(weight), rays, p=weight / weight.sum())
        up, azimuth, bright = rng.uniform(size=rays), rng.uniform(size=rays), rng.uniform(size=rays) < 0.5
        # every other ray to the bright quarter of the sky
        azimuth = np.where(bright, 0.25 * azimuth, 0.25 + 0.75 * azimuth) * 2 * np.pi - turn * 2 * np.pi / CELLS[1]
        azimuth %= 2 * np.pi
        to_sky = np.stack([np.sqrt(1 - up**2) * np.sin(azimuth), np.sqrt(1 - up**2) * np.cos(azimuth), up], axis=1)
        rows, columns = (up * CELLS[0]).astype(int), ((azimuth / (2 * np.pi)) * CELLS[1]).astype(int)
        light = world.sky[rows, (columns + turn) % CELLS[1]].mean(axis=1) * 2 * np.pi * np.where(bright, 0.5, 1.5)
        albedo = atlas[chosen, :3].mean(axis=1) / atlas[chosen, 3] * (1 + world.tint_strength * tint[chosen])
        away = np.arange(0.05, 50, 0.1)[:, None, None] * to_sky + points[chosen]
        flat_away = away.reshape(-1, 3)
        hidden = (flat_away[:, 2] < nodes(world.elevation, world.cell, flat_away[:, :2])).reshape(-1, rays).any(axis=0)
        through = np.exp(-0.1 * sample(world, flat_away)[0].reshape(-1, rays).sum(axis=0)) * ~hidden
        normal = atlas[chosen, 4:7] * 2 - 1
        found = weight.sum() * answers(normal, -directions[0, 0], to_sky, albedo) * light * through
        total, variance = total + float(found.mean()), variance + float(found.var(ddof=1)) / rays
    return total / len(origins[0]), float(np.sqrt(variance)) / len(origins[0])


def answers(normal: np.ndarray, to_eye: np.ndarray, to_light: np.ndarray, albedo: np.ndarray) -> np.ndarray:
    """Leaves that reflect and pass on half as much, leaf by leaf: radiance per irradiance across the beam."""
    n = np.arange(400) + 0.5
    z, turn = 1 - n / 200, n * np.pi * (1 + np.sqrt(5))
    wild = np.stack([np.sqrt(1 - z**2) * np.cos(turn), np.sqrt(1 - z**2) * np.sin(turn), z], axis=1)
    kappa = np.minimum(np.linalg.norm(normal, axis=1), 1)
    ordered = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    both = (ordered @ to_eye) * (ordered * to_light).sum(axis=1)
    wildly = (wild @ to_eye) * (to_light @ wild.T)
    shown = kappa * np.abs(ordered @ to_eye) + (1 - kappa) * np.abs(wild @ to_eye).mean()
    part = lambda value: np.maximum(value, 0) + 0.5 * np.maximum(-value, 0)  # noqa: E731
    return albedo / np.pi * (kappa * part(both) + (1 - kappa) * part(wildly).mean(axis=1)) / shown


POINTS = np.random.default_rng(8).uniform(-10, 100, (24, 2))
VIEW = unit((0.3, -0.4, -0.5))


def test_a_grove_under_a_lopsided_sky_agrees_with_even_steps() -> None:
    table = np.ones((*CELLS, 3)) * (1 + 9 * (np.arange(CELLS[1]) < 8))[None, :, None]
    light = level_irradiance(table)
    world = replace(WORLD, e_sun=DARK, e_sky=tuple(light), sky=table, ground_albedo=DARK,
                    leaf_transmission=(0.5, 0.5, 0.5))
    found = render(world, looking(POINTS, VIEW), np.tile(CENTRE, (16, 1)), SKY).radiance[..., :3].mean()
    expected, error = brute(world, 160, np.random.default_rng(9))
    assert error < 0.07 * expected
    assert found == pytest.approx(expected, abs=4 * error)
    other, wide = brute(world, 160, np.random.default_rng(10), turn=16)
    assert abs(other - found) > 3 * max(error, wide), "the same sky turned round"


def test_the_standard_error_is_honest() -> None:
    world = replace(WORLD, e_sun=DARK, e_sky=EVEN)
    points = np.random.default_rng(3).uniform(-10, 100, (200, 2))
    made = [render(world, looking(points, VIEW), np.tile(CENTRE, (4, 1)), replace(SKY, sky_rays=16, seed=seed))
            for seed in (1, 2)]
    apart = np.sqrt(np.mean((made[0].radiance - made[1].radiance)[..., :3].mean(axis=-1) ** 2) / 2)
    stated = np.sqrt(np.mean([m.standard_error**2 for m in made]))
    # the sequence within a pixel makes the pictures better than their independent rays would be
    assert 0.3 * stated < apart < 1.15 * stated


def test_a_sky_that_is_no_table_is_refused() -> None:
    up = np.ones((4, 8, 3))
    for table in (up[..., :2], -up, up * np.nan, np.ones((0, 8, 3))):
        with pytest.raises(InputError, match="sky"):
            flat(0, e_sky=DARK, sky=table)
    with pytest.raises(InputError, match="same light"):
        flat(0, e_sky=(1.0, 1.0, 1.0), sky=up)
    with pytest.raises(InputError, match="ray"):
        render(flat(0), looking([[0, 0]]), CENTRE, Options(sky_rays=0))
