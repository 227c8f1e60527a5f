"""The validation table through the whole of a picture: every pixel has the colour that the rule says of its point."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.core.baking import bake_key, bake_now
from renderer.core.cache import Cache
from renderer.core.params import validate
from renderer.core.technique import BakedArrays
from renderer.directional.bakes import bakes
from renderer.directional.brdf.materials import Validation
from renderer.directional.frames import quantised
from renderer.directional.state import DirectionalState
from renderer.gl.thread import GLThread
from renderer.world.camera import pose
from renderer.world.sky import sky_for
from renderer.world.sun import angles, direction
from tests.directional.light.points import local
from tests.directional.selection.world import NONE, SMALL, _picture, orbit

LIT: dict[str, Any] = {
    **SMALL,
    "selection": {"kind": "position_corrected"},
    "camera": orbit(20, 30),
    "sun": {"kind": "direction", "azimuth": 75.0, "elevation": 45.0},
    "light": {"kind": "measured_brdf", "ambient": 0.0},
}


def off(thread: GLThread, azimuths: str) -> tuple[np.ndarray, int]:
    """Differences (N, 3) of the drawn pixels from the rule, over the sun's irradiance [sr-1], and how many lie in it.

    The rule is asked in float64, of each pixel's own point: its stored place and normal, its frame, eye and sun.
    """
    cache, source = Cache(), Validation(azimuths=azimuths)
    state = validate(DirectionalState, {**LIT, "material": source.model_dump()})
    baked = {bake.name: BakedArrays(bake_key(bake), bake_now(bake, cache)) for bake in bakes(state)}
    picture, points = thread.call(_picture, state, baked)
    points = points[::-1, :, 0]
    drawn = points != NONE
    used = baked["visibility"].arrays["used"][points[drawn]]
    cloud = baked["cloud"].arrays
    normals = quantised(cloud["normal"][used].astype(np.float64))
    to_eye = pose(state.camera).eye - cloud["position"][used].astype(np.float64)
    to_eye /= np.linalg.norm(to_eye, axis=1, keepdims=True)
    sun = np.asarray(direction(state.sun))
    view, light = local(normals, to_eye), local(normals, np.broadcast_to(sun, normals.shape))
    theta_o, theta_l = (np.arccos(np.clip(way[:, 2], 0, 1)) for way in (view, light))
    phi_o, phi_l = (np.arctan2(way[:, 1], way[:, 0]) for way in (view, light))
    rule = source.colours((theta_o, phi_o, theta_l, phi_l if azimuths == "both" else phi_l - phi_o))
    sent = np.asarray(picture[drawn][:, :3], np.float64)
    arriving = sky_for(baked["sky"].arrays, angles(state.sun)[1]).sun_irradiance
    return sent / arriving - rule * np.maximum(light[:, 2:], 0), int((light[:, 2] > 0).sum())


@pytest.mark.parametrize("azimuths", ["difference", "both"])
def test_every_pixel_is_coloured_as_the_rule_says(thread: GLThread, azimuths: str) -> None:
    difference, lit = off(thread, azimuths)
    assert lit > 200
    assert np.abs(difference).max() < 1e-5  # half of it: places of 16 bits a coordinate move the view by 1e-5 rad


def test_a_tangent_turned_round_is_found(thread: GLThread, spoil: Callable) -> None:
    right, wrong = "dot(direction, surfel.tangent), dot", "-dot(direction, surfel.tangent), dot"
    with spoil("directional/light/measured_brdf.glsl", right, wrong):
        assert np.abs(off(thread, "both")[0]).max() > 0.01
