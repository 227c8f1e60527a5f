"""The nearest direction: exact where a view looks along one, counted as the thesis counts, and off between them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from renderer.directional.casting import face_frame
from renderer.directional.hemisphere import hemisphere_of
from renderer.gl.thread import GLThread
from tests.directional.selection.world import NONE, draw, orbit, parallel

NEAREST = {"kind": "nearest", "magnification": "nearest"}
ALONG = hemisphere_of(129).directions()[16 * 6 + 3] @ face_frame(3)
"""A direction that the hemisphere of the face +y has, steep enough that the other faces are seen slantwise."""


def distances(drawn: object) -> np.ndarray:
    """From the points that the strip of +y shows to the lines through its texels, in texels."""
    positions, box = drawn.positions, drawn.box  # type: ignore[attr-defined]
    strip = drawn.points[:, 64:128, 0]  # type: ignore[attr-defined]
    seen = strip != NONE
    rows, columns = np.nonzero(seen)
    share = np.stack([(columns + 0.5) / 64, (rows + 0.5) / 64], axis=-1)
    places = np.empty((len(rows), 3))
    places[:, [0, 2]] = box[0, [0, 2]] + share * (box[1] - box[0])[[0, 2]]
    places[:, 1] = box[1, 1]
    away = positions[strip[seen]] - places
    return np.linalg.norm(away - (away @ ALONG)[:, None] * ALONG, axis=1) / ((box[1] - box[0]).max() / 64)


def test_along_a_direction_each_texel_shows_what_lies_behind_it(thread: GLThread) -> None:
    drawn = draw(thread, {"selection": NEAREST, "camera": parallel(ALONG)})
    away = distances(drawn)
    assert len(away) > 500
    assert np.percentile(away, 99) < 0.8  # the points' own spacing; a texel beside would be 1 off
    assert drawn.wrong < 0.16  # texels are 1.5 pixels wide


def test_at_most_three_faces_are_lit(thread: GLThread) -> None:
    drawn = draw(thread, {"selection": NEAREST, "camera": orbit(30, 25)})
    assert drawn.points.shape == (64, 3 * 64, 1)
    lit = int((drawn.points != NONE).sum())
    assert 0 < lit <= 3 * 64**2


def test_between_directions_edges_leap(thread: GLThread) -> None:
    along = draw(thread, {"selection": NEAREST, "camera": parallel(ALONG)}).wrong
    between = draw(thread, {"selection": NEAREST, "camera": orbit(30, 25)}).wrong
    assert between > 1.3 * along


def test_a_neighbour_instead_of_the_nearest_is_found(thread: GLThread, spoil: Callable) -> None:
    with spoil(
        "directional/selection/nearest.glsl",
        "to_face(face, to_eye), VIEW",
        "normalize(to_face(face, to_eye) + vec3(0.12, 0.0, 0.12)), VIEW",
    ):
        drawn = draw(thread, {"selection": NEAREST, "camera": parallel(ALONG)})
    assert np.percentile(distances(drawn), 99) > 0.8
