"""Perspective shadow map: where shadows end, its homography in GLSL, and its distance to the reference."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.forest.shadow.perspective_shadow_map import PerspectiveShadowMap
from tests.forest import worlds
from tests.forest.shadow.banks import bank, edge_error, far_side_is_lit, holds_cost
from tests.forest.truth import Judge

Paint = Callable[..., Any]
Ask = Callable[..., np.ndarray]
KIND = "perspective_shadow_map"
FIXED = {"resolution": 1024, "threshold": 0.3, "bias": 0.3, "texel_bias": 0.25}
"""Pinned, so that a tuned default leaves the measured cost alone."""
COST = 0.079
"""As the plain map's, with texels of other sizes."""
PASS = "forest/shadow/perspective_shadow_map_depth.glsl"
FRAME = "forest/shadow/perspective_shadow_map.glsl"


@pytest.mark.parametrize("elevation", [25.0, 30.0])
def test_a_brinks_shadow_ends_where_geometry_says(paint: Paint, elevation: float) -> None:
    # Seen in parallel the map is the plain one: a texel of 44 m / 512, and half a pixel.
    assert edge_error(paint, KIND, elevation) < 0.1 / np.sin(np.radians(elevation)) + 0.13


def seen_edge(paint: Paint, **shadow: Any) -> float:
    """Share of lit pixels of a strip across the bank's shadow, seen in perspective from the south."""
    camera = {"kind": "look", "eye": [22, -60, 30], "target": [22, 0, 0], "field_of_view": 30}
    made = worlds.state(
        camera=camera, sun=worlds.sun(270, 30.0 + 1e-3 * len(shadow)), **worlds.with_technique("shadow", KIND, **shadow)
    )
    row = paint(made, bank(), (96, 96), 1).linear[48, :, 0]
    return float((row > 0.5 * row.max()).mean())


def test_the_shadow_ends_there_in_perspective_too(paint: Paint) -> None:
    """The middle row looks at y = 0 on level ground, 18.1 m to either side of x = 22, 67 m off."""
    half = np.hypot(60, 30) * np.tan(np.radians(15))
    end = -20 + 24 / np.tan(np.radians(30))
    exact = (22 + half - end) / (2 * half)
    assert seen_edge(paint) == pytest.approx(exact, abs=0.02)


@pytest.mark.parametrize(
    ("file", "right", "wrong"),
    [
        (FRAME, "vec2 place = projected.xy / projected.z;", "vec2 place = projected.xy;"),
        (PASS, "return line.xy / line.z;", "return line.xy;"),
        (PASS, "line + shadow_anchor", "line - shadow_anchor"),
    ],
)
def test_a_wrong_projection_is_found(paint: Paint, spoil: Callable, file: str, right: str, wrong: str) -> None:
    half = np.hypot(60, 30) * np.tan(np.radians(15))
    exact = (22 + half + 20 - 24 / np.tan(np.radians(30))) / (2 * half)
    given = {"bias": 0.3 + 1e-4 * len(wrong), "strength": 1.0}
    with spoil(file, right, wrong):
        assert abs(seen_edge(paint, **given) - exact) > 0.04


def test_a_sun_from_the_other_side_lights_the_foot_of_the_bank(paint: Paint) -> None:
    far_side_is_lit(paint, KIND)


def test_points_are_looked_up_through_the_homography(ask: Ask) -> None:
    """Twin: the texel is where the map's homography puts the point; beyond the map nothing is known to shade."""
    rng = np.random.default_rng(3)
    made = PerspectiveShadowMap(bias=1.0, texel_bias=0.0, strength=0.8)
    to_map = np.array([[0.02, 0.001, 0.4], [0.002, 0.015, 0.3], [0.004, -0.003, 1.0]])
    first = rng.uniform(30, 60, (8, 8)).astype(np.float32)
    position = rng.uniform((-40, -40, 20), (60, 60, 70), (600, 3)).astype(np.float32)
    found = ask(
        [FRAME],
        "shadow_visibility(position, 0.0, vec2(0.0))",
        {"position": position},
        state=worlds.state(sun=worlds.sun(0, 90)),
        techniques={"shadow": made},
        textures={"shadow_depth": first},
        values={
            "shadow_anchor": (10.0, 5.0),
            "shadow_to_map": to_map,
            "shadow_to_light": np.linalg.inv(to_map),
            "shadow_right": (1.0, 0.0, 0.0),
            "shadow_up": (0.0, 1.0, 0.0),
        },
    )[:, 0]
    across = np.concatenate([position[:, :2].astype(np.float64) - (10, 5), np.ones((600, 1))], axis=1)
    projected = across @ to_map.T
    place = projected[:, :2] / projected[:, 2:]
    column, row = np.clip(np.floor(8 * place), 0, 7).astype(int).T
    inside = ((place >= 0) & (place <= 1)).all(axis=1)
    exact = np.where(inside & (position[:, 2] < first[row, column] - 1), 0.2, 1.0)
    clear = (np.abs(8 * place - np.rint(8 * place)) > 1e-3).all(axis=1)
    np.testing.assert_allclose(found[clear], exact[clear], atol=1e-6)
    assert set(np.round(exact, 1)) == {0.2, 1.0}


def test_every_texel_changes_its_line_when_the_camera_moves() -> None:
    """What a snapped map prevents: the published vibration."""

    def first_line(y: float) -> np.ndarray:
        camera = {"kind": "look", "eye": [0, y, 60], "target": [0, y + 300, 0], "field_of_view": 40}
        state = worlds.state(camera=camera, sun=worlds.sun(140, 35))
        found = PerspectiveShadowMap().sun_pass(state, {"terrain": worlds.ground()}, (64, 64))
        assert found is not None
        back = np.array(found.uniforms["shadow_to_light"]) @ (0.5, 0.5, 1.0)
        return np.asarray(back[:2] / back[2] + found.uniforms["shadow_anchor"])

    assert np.linalg.norm(first_line(-100.0) - first_line(-100.3)) > 0.05


def test_distance_to_the_reference(judge: Judge) -> None:
    holds_cost(judge, KIND, COST, FIXED)


def test_picture(judge: Judge) -> None:
    judge.looks("shadow", KIND)
