"""Five bilinear interpolations: the validation table's rule everywhere, the twin, wraps, clamps, mistakes found."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

from renderer.directional.brdf.lookup import lookup
from renderer.directional.brdf.materials import (
    AnyMaterial,
    Matte,
    Metal,
    Satin,
    Validation,
    bake_brdf,
    brdf_bake,
    table_of,
)
from renderer.directional.brdf.resident import DECLARATIONS, table_macros, table_uniforms
from renderer.directional.lamp import Lamp
from renderer.directional.light.measured_brdf import MeasuredBrdf
from renderer.gl.context import GL
from renderer.gl.probe import probe
from renderer.gl.thread import GLThread
from renderer.world.brdf import BrdfTable, direction_of
from tests.directional.light.points import COLOUR, SHADE, SKY, SUN, local, random_directions, shaded

FILE = "directional/brdf_table.glsl"
NORMAL = np.array([0.0, 0.0, 1.0])


def baked(source: AnyMaterial) -> Mapping[str, Any]:
    return {"brdf": bake_brdf(brdf_bake(source).arguments, {}, lambda share, words: None)}


def of_table(table: BrdfTable) -> Mapping[str, Any]:
    """What a bake would give for a table."""
    found = baked(Validation())["brdf"] | {f"nodes_{axis}": nodes for axis, nodes in enumerate(table.nodes)}
    order = ("angles", "difference", "half").index(table.coordinates)
    return {"brdf": found | {"values": table.values.astype(np.float32), "coordinates": np.array(order)}}


def drawn(thread: GLThread, arrays: Mapping[str, Any], storage: str = "float", seed: int = 7) -> tuple[np.ndarray, ...]:
    """Reflectance by GLSL (N, 3) for 1,000 random pairs of view and light (N, 3), these as float32 has them."""
    technique = MeasuredBrdf(storage=storage)
    view, light = random_directions(1000, seed), random_directions(1000, seed + 1)
    pairs = {"view": view.astype(np.float32), "light": light.astype(np.float32)}

    def run(gl: GL) -> np.ndarray:
        made = technique.textures_of(gl, arrays)
        try:
            named = {f"light_{name}": texture for name, texture in made.items()}
            table = table_of(arrays["brdf"])
            return probe(gl, [FILE], "table_reflectance(view, light)", pairs, 3, uniforms=table_uniforms(table),
                         textures=named, declarations=DECLARATIONS, defines=table_macros(table))
        finally:
            for texture in made.values():
                texture.release()

    return thread.call(run).astype(np.float64), *(way.astype(np.float64) for way in pairs.values())


def rule(source: Validation, view: np.ndarray, light: np.ndarray) -> np.ndarray:
    """What the validation table's rule says of pairs of directions, (N, 3) [sr-1]."""
    theta = [np.arccos(np.clip(way[:, 2], -1, 1)) for way in (view, light)]
    phi_o, phi_l = (np.arctan2(way[:, 1], way[:, 0]) for way in (view, light))
    return source.colours((theta[0], phi_o, theta[1], phi_l if source.azimuths == "both" else phi_l - phi_o))


@pytest.mark.parametrize("azimuths", ["both", "difference"])
def test_the_validation_table_colours_as_its_rule_says(thread: GLThread, azimuths: str) -> None:
    source = Validation(azimuths=azimuths)
    found, view, light = drawn(thread, baked(source))
    assert np.abs(found - rule(source, view, light)).max() < 1e-5  # sr-1, of up to 0.76


@pytest.mark.parametrize("azimuths", ["both", "difference"])
def test_it_colours_points_of_all_orientations(thread: GLThread, azimuths: str) -> None:
    """The same through the points' own frames, the sun's light and the shadow."""
    source = Validation(azimuths=azimuths)
    sun, normals, to_eye = random_directions(1, 2)[0], random_directions(1000, 3), random_directions(1000, 4)
    normals *= np.sign(normals @ sun)[:, None]
    to_eye *= np.sign((to_eye * normals).sum(axis=1))[:, None]
    seen = shaded(thread, MeasuredBrdf(ambient=0.0), baked(source), normals, to_eye, sun)
    view, light = local(normals, to_eye), local(normals, np.broadcast_to(sun, normals.shape))
    assert np.abs(seen / (SUN * SHADE) - rule(source, view, light) * light[:, 2:]).max() < 1e-5


@pytest.mark.parametrize("source", [Validation(azimuths="both"), Validation(), Satin(), Matte(), Metal()], ids=repr)
def test_glsl_equals_its_twin(thread: GLThread, source: AnyMaterial) -> None:
    arrays = baked(source)
    found, view, light = drawn(thread, arrays)
    table = table_of(arrays["brdf"])
    scale = max(1.0, float(table.values.max()))  # the metal's and the satin's peaks are tens of sr-1
    assert np.abs(found - lookup(table, view, light)).max() < 1e-5 * scale


def uneven(coordinates: str = "angles") -> BrdfTable:
    """Random numbers at uneven nodes that neither start at 0 nor end at the horizon."""
    rng = np.random.default_rng(11)
    theta_o, theta_l = np.radians([5.0, 12, 40, 41, 80]), np.radians([0.0, 33, 70])
    phi_o, phi_l = np.radians([10.0, 20, 100, 300]), np.radians([-170.0, -20, 3, 4.5, 111])
    nodes = (theta_o, phi_o if coordinates == "angles" else np.zeros(1), theta_l, phi_l)
    return BrdfTable(coordinates, nodes, rng.random((*map(len, nodes), 3)))


@pytest.mark.parametrize("coordinates", ["angles", "difference"])
def test_uneven_nodes_are_found(thread: GLThread, coordinates: str) -> None:
    table = uneven(coordinates)
    found, view, light = drawn(thread, of_table(table))
    # 1.5 degrees between two nodes: angles of float32 are good to 4e-7 rad of 0.026
    assert np.abs(found - lookup(table, view, light)).max() < 4e-5


@pytest.mark.parametrize(("right", "wrong"), [
    ("floor(along / said.y)", "0.0"),
    ("vec3 ca = c0 + share.y * (c3 - c0);", "vec3 ca = c0 + share.y * (c2 - c0);"),
    ("ca + share.x * (cb - ca)", "ca + share.y * (cb - ca)"),
    ("(second_phi ? share.y : 1.0 - share.y)", "0.5"),
    ("clamp(along, 0.0, said.z - said.x)", "max(along, 0.0) * 1.1"),
    ("table_theta(view), table_azimuth(view.xy), table_theta(light), table_azimuth(light.xy)",
     "table_theta(light), table_azimuth(light.xy), table_theta(view), table_azimuth(view.xy)"),
])  # fmt: skip
def test_a_spoiled_interpolation_is_found(thread: GLThread, spoil: Callable, right: str, wrong: str) -> None:
    """Among them an azimuth that does not wrap, corners in the wrong order, and light exchanged with view."""
    source = Validation(azimuths="both")
    with spoil(FILE, right, wrong):
        found, view, light = drawn(thread, baked(source))
    assert not np.abs(found - rule(source, view, light)).max() < 1e-5


def at(theta_o: float, phi_o: float, theta_l: float, phi_l: float, table: BrdfTable) -> np.ndarray:
    """Values between nodes, angles in degrees."""
    view, light = (direction_of(*np.radians([[t], [p]])) for t, p in ((theta_o, phi_o), (theta_l, phi_l)))
    return lookup(table, view, light)[0]


def test_azimuths_wrap() -> None:
    """Between the last node and the first, and past a whole turn."""
    table = uneven()
    last, first = (at(40.0, 10.0, 33.0, phi, table) for phi in (111.0, 190.0))
    for share in (0.25, 0.7):
        between = at(40.0, 10.0, 33.0, 111.0 + share * 79.0, table)
        assert between == pytest.approx((1 - share) * last + share * first, rel=1e-9)
    assert at(40.0, 5.0, 33.0, 0.0, table) == pytest.approx(at(40.0, 365.0, 33.0, -360.0, table), rel=1e-9)
    view = [at(40.0, phi, 33.0, 0.0, table) for phi in (300.0, 335.0, 370.0)]
    assert view[1] == pytest.approx((view[0] + view[2]) / 2, rel=1e-9)


def test_the_horizon_clamps() -> None:
    """Beyond the last angle and before the first their values stand; a view from below counts as level."""
    table = uneven()
    assert at(80.0, 50.0, 70.0, 50.0, table) == pytest.approx(at(89.9, 50.0, 88.0, 50.0, table), rel=1e-9)
    assert at(5.0, 50.0, 30.0, 50.0, table) == pytest.approx(at(1.0, 50.0, 30.0, 50.0, table), rel=1e-9)
    assert at(100.0, 50.0, 30.0, 50.0, table) == pytest.approx(at(90.0, 50.0, 30.0, 50.0, table), rel=1e-9)


def test_light_from_below_gives_nothing_and_the_ambient_term_stays(thread: GLThread) -> None:
    technique = MeasuredBrdf(ambient=0.5)
    normals, to_eye = np.array([[0.0, 0, 1], [0, 1, 0]]), np.array([[0.0, 0, 1], [0, 1, 0]])
    found = shaded(thread, technique, baked(Matte()), normals, to_eye, np.array([0.0, -0.6, -0.8]),
                   openness=np.array([1.0, 0.5]))
    right = 0.5 * COLOUR / np.pi * SKY * np.array([[1.0], [0.25]])
    np.testing.assert_allclose(found, right, rtol=1e-5)


def test_a_lamp_adds_its_own(thread: GLThread) -> None:
    """With the lamp where the sun is, as far off as makes its light the sun's."""
    technique, to_eye = MeasuredBrdf(ambient=0.0), np.array([[0.3, 0.4, 3**0.5 / 2]])
    sun = np.array([0.36, -0.48, 0.8])
    lamp = Lamp(lit=True, place=tuple(10 * sun), intensity=100 * 900.0, colour=tuple(SUN / 900.0))
    alone = shaded(thread, technique, baked(Matte()), NORMAL[None], to_eye, sun)
    both = shaded(thread, technique, baked(Matte()), NORMAL[None], to_eye, sun, lamp)
    np.testing.assert_allclose(both, 2 * alone, rtol=1e-5)


def test_half_precision_errs_by_its_rounding_alone(thread: GLThread) -> None:
    arrays = baked(Satin())
    full, _, _ = drawn(thread, arrays, "float")
    half, _, _ = drawn(thread, arrays, "half")
    assert (np.abs(half - full) / np.maximum(full, 1e-3)).max() < 2.0**-11 * 1.01
