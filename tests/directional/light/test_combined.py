"""Everything at once is the sum of its parts, each by its share."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from renderer.directional.brdf.materials import Matte, brdf_bake
from renderer.directional.environment_light import SHARPEST
from renderer.directional.environments import Studio, environment_bake
from renderer.directional.lamp import Lamp
from renderer.directional.light.combined import Combined
from renderer.directional.light.environment import EnvironmentMap
from renderer.directional.light.measured_brdf import MeasuredBrdf
from renderer.directional.light.phong import Phong
from renderer.directional.light_world import light_world
from renderer.directional.technique import DirectionalTechnique
from renderer.gl.thread import GLThread
from renderer.reference.directional_world import part_of
from renderer.world.sun import SunDirection, direction
from tests.directional.light.points import kept, random_directions, shaded, sky_tables

SUN = SunDirection(azimuth=120.0, elevation=40.0)
LAMP = Lamp(lit=True, place=(0.3, 0.8, 1.4), intensity=300.0)


@pytest.fixture(scope="module")
def baked() -> Mapping[str, Any]:
    return {
        "sky": sky_tables(),
        "environment": kept(environment_bake(Studio())[0]),
        "brdf": kept(brdf_bake(Matte())),
    }


def drawn(thread: GLThread, baked: Mapping[str, Any], technique: DirectionalTechnique) -> np.ndarray:
    normals, to_eye = random_directions(300, 1), random_directions(300, 2)
    normals[::2] *= -1
    around = {"environment": Studio(rotation=20.0), "sun": SUN}
    sun = np.asarray(direction(SUN))
    return shaded(thread, technique, baked, normals, to_eye, sun, LAMP, surroundings=around)


@pytest.mark.parametrize("surface", ["phong", "measured"])
def test_the_sum_of_its_parts(thread: GLThread, baked: Mapping[str, Any], surface: str) -> None:
    own: dict[str, Any] = {"surface": surface, "diffuse": 0.5, "specular": 0.2, "shininess": 30.0}
    shares = {"surface_share": 0.8, "environment_share": 1.5, "matt": 0.3, "mirror": 0.4, "mirror_shininess": SHARPEST}
    whole = drawn(thread, baked, Combined(**own, **shares))
    phong = Phong(ambient=0.0, diffuse=0.5, specular=0.2, shininess=30.0)
    lit = drawn(thread, baked, phong if surface == "phong" else MeasuredBrdf(ambient=0.0))
    around = drawn(thread, baked, EnvironmentMap(diffuse=0.3, specular=0.4))
    np.testing.assert_allclose(whole, 0.8 * lit + 1.5 * around, rtol=1e-4, atol=1e-3)
    assert lit.mean() > 1  # W m-2 sr-1
    assert around.mean() > 1


@pytest.mark.parametrize("lamp", [LAMP, Lamp()], ids=["lit", "out"])
def test_the_reference_is_told_of_every_kind(baked: Mapping[str, Any], lamp: Lamp) -> None:
    parts = {
        Phong(ambient=0.4): [("phong", 1.0)],
        MeasuredBrdf(): [("measured", 1.0)],
        EnvironmentMap(): [("surroundings", 1.0)],
        Combined(surface="phong", surface_share=0.8, environment_share=0.5): [("phong", 0.8), ("surroundings", 0.5)],
        Combined(surface_share=0.7): [("measured", 0.7), ("surroundings", 1.0)],
    }
    for light, expected in parts.items():
        state = SimpleNamespace(environment=Studio(), sun=SUN, lamp=lamp, light=light)
        told = light_world(state, baked)
        assert (told["lamp"] is None) is not lamp.lit
        found = [part_of(part) for part in told["parts"]]
        assert [(type(part).__name__.lower(), weight) for weight, part in found] == expected


def test_without_a_table_none_is_baked() -> None:
    state = SimpleNamespace(environment=Studio(), material=Matte())
    assert [bake.name for bake in Combined(surface="phong").bakes(state)] == ["environment"]
    assert [bake.name for bake in Combined().bakes(state)] == ["brdf", "environment"]
