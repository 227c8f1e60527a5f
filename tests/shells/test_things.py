"""Other meshes of the scene beside the float64 reference, and beside what can be said of their light on paper."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from renderer.core.baking import bake_now
from renderer.core.cache import AssetStore, Cache
from renderer.core.errors import InputError, InvalidDocument
from renderer.core.params import validate
from renderer.core.technique import Arrays
from renderer.shells.bakes import bakes, sky_bake
from renderer.shells.probe import probe
from renderer.shells.program import compose_source, walk_source
from renderer.shells.state import ShellsState
from renderer.shells.thing_shapes import SHAPES
from renderer.shells.things import bake_things, placed_things, thing_arguments
from renderer.world.sky import sky_for
from tests.shells.conftest import even
from tests.shells.test_against_reference import GLOBE, apart, blobs, reference

Draw = Callable[..., np.ndarray]

SUN = {"kind": "direction", "azimuth": 60, "elevation": 50}
LIT = {"light": {"kind": "lambert"}, "sun": SUN, "shadow": {"kind": "deep_shadow_map", "resolution": 512}}
AROUND = [
    {"kind": "ground", "position": [0, 0, -0.9], "size": 6, "colour": [0.5, 0.4, 0.3]},
    {"kind": "box", "position": [0.3, 0.5, -0.2], "width": 0.5, "depth": 0.4, "height": 0.6, "colour": [0.7, 0.2, 0.1]},
    {"kind": "ball", "position": [-0.9, -0.4, -0.9], "radius": 0.3, "colour": [0.2, 0.5, 0.6]},
]
"""What stands on a level square, what reaches into the shell of `GLOBE`, and what stands beside it."""

FINE = {"kind": "adaptive", "rate": 4.0, "jitter": 0.0, "most": 256}


def baked(state: ShellsState) -> Arrays:
    return bake_things(thing_arguments(state.things), {}, lambda share, words: None)


@pytest.mark.parametrize("kind", sorted(SHAPES))
def test_shapes_stand_on_their_underside_and_look_outwards(kind: str) -> None:
    state = validate(ShellsState, {"scene": "shells", "things": {"list": [{"kind": kind, "position": [1, 2, 3]}]}})
    placed = placed_things(state.things, baked(state))
    assert placed.corners[..., 2].min() == pytest.approx(3)
    own = np.cross(placed.corners[:, 1] - placed.corners[:, 0], placed.corners[:, 2] - placed.corners[:, 0])
    assert (np.einsum("fi,fki->fk", own, placed.normals) > 0).all()
    assert np.allclose(np.linalg.norm(placed.normals, axis=-1), 1)
    if kind != "ground":
        away = placed.corners.mean(axis=1) - placed.corners.reshape(-1, 3).mean(axis=0)
        assert np.einsum("fi,fi->", own, away) > 0, "faces of a closed shape enclose a volume"


def test_a_document_without_them_asks_nothing_of_the_shaders() -> None:
    plain = validate(ShellsState, {"scene": "shells"})
    beside = validate(ShellsState, {"scene": "shells", "things": {"list": [{"kind": "ball"}]}})
    for make in (lambda state: walk_source(state, False), compose_source):
        assert "sampler2D thing_seen" not in make(plain).text
        assert "sampler2D thing_seen" in make(beside).text


def test_ground_under_even_matter_has_the_light_that_is_left(draw: Draw) -> None:
    """A slab of optical depth 0.4 straight down, through whose flat sides the sun comes at 50 degrees: beside it in its
    shadow the ground has exp(-0.4 / sin 50 deg) of the sun."""
    lifted = np.sin(np.radians(50))
    camera = {"kind": "orthographic", "centre": [-1.2, 0, 0], "direction": [0, 0, -1], "up": [0, 1, 0], "width": 0.2}
    ground = {"kind": "ground", "position": [0, 0, -1.2], "size": 8, "colour": [0.5, 0.5, 0.5]}
    patch = {**LIT, "sun": {"kind": "direction", "azimuth": 90, "elevation": 50}, "camera": camera,
             "things": {"list": [ground]}}  # fmt: skip
    state = validate(ShellsState, {"scene": "shells", "sun": patch["sun"]})
    now = sky_for(bake_now(sky_bake(state), Cache()), np.radians(50))
    for depth in (0.0, 0.4, 1.5):
        found = draw(patch, even(1 - np.exp(-0.1 * depth / 0.5)), size=4)[..., :3]
        arriving = now.sun_irradiance * lifted * np.exp(-depth / lifted) + now.sky_irradiance
        assert np.allclose(found, 0.5 / np.pi * arriving, rtol=2e-3), "0.1 m hide what the texture says"


@pytest.fixture(scope="module")
def right() -> np.ndarray:
    """The reference's picture of all that stands in `AROUND`."""
    return reference({**GLOBE, **LIT, "things": {"list": AROUND}}, blobs())


def test_things_hide_and_shade_as_the_reference_has_it(draw: Draw, right: np.ndarray) -> None:
    """1.6 % of root mean square, nearly all of it in the few pixels where a shadow ends, whose edge a map of 512 texels
    softens: nine of ten are right to 0.7 %."""
    patch = {**GLOBE, **LIT, "things": {"list": AROUND}, "sampling": FINE}
    found = draw(patch, blobs(), size=24, samples=16)
    assert apart(found, right) < 0.02
    each = np.abs(found - right)[..., :3].max(axis=-1) / np.sqrt(np.mean(right[..., :3] ** 2))
    assert np.quantile(each, 0.9) < 0.015
    astray = [AROUND[0], {**AROUND[1], "position": [0.3, 0.55, -0.2]}, AROUND[2]]
    moved = draw({**patch, "things": {"list": astray}}, blobs(), size=24, samples=4)
    assert apart(moved, right) > 0.04, "5 cm to the side are seen to differ"


def test_all_orders_end_their_rays_at_things(draw: Draw) -> None:
    """The thing that reaches into the shell cuts cells in two: each order draws the near part of them."""
    patch = {**GLOBE, **LIT, "things": {"list": AROUND}, "sampling": FINE}
    walked = draw(patch, blobs(), size=16)
    for order in ("depth_peeling", "sxmpvo", "k_buffer", "fragment_lists"):
        assert apart(draw({**patch, "order": {"kind": order}}, blobs(), size=16), walked) < 1e-3, order
    assert apart(draw({**patch, "order": {"kind": "moments"}}, blobs(), size=16), walked) < 0.05, "its own error"
    assert apart(draw({**patch, "things": {"list": AROUND[:1]}}, blobs(), size=16), walked) > 0.1


def test_things_shine_by_themselves_where_matter_does(draw: Draw) -> None:
    ground = {"kind": "ground", "position": [0, 0, -1], "size": 8, "colour": [0.2, 0.5, 0.7]}
    found = draw({"light": {"kind": "unlit", "level": 3.0}, "things": {"list": [ground]}}, even(0.0), size=4)
    assert np.allclose(found, [0.6, 1.5, 2.1, 1.0], rtol=1e-5)


def test_refusals_name_the_thing() -> None:
    many = {"scene": "shells", "things": {"list": [{"kind": "ball"}] * 9}}
    with pytest.raises(InvalidDocument, match=r"things.list: .*at most 8"):
        validate(ShellsState, many)
    lost = {"kind": "asset", "asset": "asset:" + "0" * 64}
    state = validate(ShellsState, {"scene": "shells", "things": {"list": [{"kind": "ball"}, lost]}})
    with pytest.raises(InputError) as refused:
        baked(state)
    assert refused.value.field == "things.list.1.asset"


def test_an_uploaded_mesh_stands_as_large_as_it_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A tetrahedron far from its file's origin, twice as wide as high."""
    monkeypatch.setenv("UMBRAGE_CACHE", str(tmp_path))
    text = "v 10 10 5\nv 14 10 5\nv 10 14 5\nv 10 10 7\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
    held = AssetStore().put(text.encode(), "mesh", "corner.obj")
    thing = {"kind": "asset", "asset": f"asset:{held}", "size": 2.0, "position": [1, 0, 0], "colour": [0.5, 1, 1]}
    state = validate(ShellsState, {"scene": "shells", "things": {"list": [thing]}})
    placed = placed_things(state.things, baked(state))
    places = placed.corners.reshape(-1, 3)
    assert np.allclose(places.min(axis=0), [0, -1, 0])
    assert np.allclose(places.max(axis=0), [2, 1, 1])
    assert np.allclose(placed.albedo, np.array([0.2, 0.4, 0.4])), "half of the red of a grey that no file named"


def test_a_value_out_of_range_is_refused_where_the_document_has_it() -> None:
    document = {"scene": "shells", "things": {"list": [{"kind": "ball"}, {"kind": "box", "width": 5000}]}}
    with pytest.raises(InvalidDocument, match=r"^things\.list\.1\.width: .*at least 0\.001, at most 1000 m"):
        validate(ShellsState, document)


def test_a_point_of_the_picture_tells_which_thing_lies_there() -> None:
    """The ball before the shell, the shell before the ground, the ground beside both, and nothing above."""
    camera = {"kind": "orthographic", "centre": [0, 0, 0], "direction": [0, 1, 0], "up": [0, 0, 1], "width": 4}
    ball = {"kind": "ball", "position": [-1, -2, -0.3], "radius": 0.3}
    ground = {"kind": "ground", "position": [0, 0, -1], "size": 3}
    document = {"scene": "shells", "camera": camera, "things": {"list": [ground, ball]}}
    state = validate(ShellsState, {**document, "surface": {"kind": "sphere", "radius": 0.6, "divisions": 4}})
    arrays = {bake.name: bake_now(bake, Cache()) for bake in bakes(state)}

    def at(x: float, z: float) -> dict[str, Any]:
        return probe(state, arrays, 0.5 + x / 4, 0.5 - z / 4, (64, 64))

    assert at(-1, 0)["thing"] == "2. ball"
    assert at(-1, 0)["position"][1] == pytest.approx(-2.3, abs=0.01)
    assert "tetrahedra" in at(0, 0)
    assert at(1, 1.5) == {"sky": True}
    lower = validate(ShellsState, {**state.model_dump(), "camera": {**camera, "direction": [0, 0.6, -0.8]}})
    assert probe(lower, arrays, 0.75, 0.5, (64, 64))["thing"] == "1. ground"
