"""Key frames of a texture: even between two, the same on the GPU as for the reference, and without a bake."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.core.baking import bake_now
from renderer.core.cache import Cache
from renderer.core.errors import InvalidDocument
from renderer.core.params import validate
from renderer.shells.bakes import bakes
from renderer.shells.course import MOST_KEYS, Course, Key, between, key_at, texture_moment
from renderer.shells.state import ShellsState
from renderer.shells.texture.fur import Fur
from renderer.shells.texture.rocks import Rocks
from renderer.shells.world_arrays import world_arrays
from tests.shells.conftest import even

Draw = Callable[..., np.ndarray]
KEYS = Course(period=8, keys=(Key(at=6, growth=1.0), Key(at=2, growth=0.2, slide_u=0.5), Key(at=4, growth=0.6)))


def test_between_key_frames_all_changes_evenly_and_round_and_round() -> None:
    for time, growth in ((2, 0.2), (3, 0.4), (4, 0.6), (5, 0.8), (6, 1.0), (8, 0.6), (9, 0.4), (10, 0.2), (27, 0.4)):
        assert key_at(KEYS, time).growth == pytest.approx(growth), time
    assert key_at(KEYS, 3).slide_u == pytest.approx(0.25)
    # A key frame at the period's end is where the next round begins.
    whole = Course(period=5, keys=(Key(at=0), Key(at=5, slide_u=2)))
    assert key_at(whole, 4.999).slide_u == pytest.approx(2, abs=1e-3)
    assert key_at(whole, 5.001).slide_u == pytest.approx(0, abs=1e-3)


def test_a_texture_takes_what_it_has_times_its_own_and_whole_repeats_do_nothing() -> None:
    assert texture_moment(Fur(growth=0.5), KEYS, 4).words == {"growth": pytest.approx(0.3), "density": 1.0}
    assert texture_moment(Rocks(), KEYS, 4).words == {}
    far = Course(keys=(Key(slide_v=-3.25),))
    assert texture_moment(Rocks(), far, 1).slide == (0.0, 0.75)
    assert texture_moment(Rocks(), far, 1, wraps=False).slide == (0.0, -3.25)
    still = texture_moment(Fur(growth=0.5), Course(), 4)
    assert still.words == {"growth": 0.5, "density": 1.0}
    assert still.slide == (0.0, 0.0)


def test_a_moment_needs_no_bake_and_too_many_keys_are_refused() -> None:
    still = validate(ShellsState, {"scene": "shells"})
    moving = validate(ShellsState, {"scene": "shells", "course": KEYS.model_dump(mode="json"), "time": 3})
    assert [bake.arguments for bake in bakes(still)] == [bake.arguments for bake in bakes(moving)]
    with pytest.raises(InvalidDocument, match=r"course\.keys"):
        validate(ShellsState, {"scene": "shells", "course": {"keys": [{"at": 0}] * (MOST_KEYS + 1)}})


@pytest.mark.parametrize("order", ["walk", "fragment_lists"])
def test_a_slide_by_voxels_is_the_block_turned_round(draw: Draw, order: str) -> None:
    """And by a quarter of the block is not by a half."""
    rng = np.random.default_rng(3)
    block = np.concatenate([rng.uniform(0.2, 1, (2, 4, 4, 3)), rng.uniform(0, 0.5, (2, 4, 4, 1))], axis=-1)
    plain = {"order": {"kind": order}}
    slid = {**plain, "course": {"keys": [{"slide_u": 0.25, "slide_v": -0.5}]}}
    found = draw(slid, block)
    expected = draw(plain, np.roll(block, (2, -1), axis=(1, 2)))
    np.testing.assert_allclose(found, expected, atol=2e-5)
    assert abs(found - draw(plain, np.roll(block, (2, -2), axis=(1, 2)))).max() > 0.05


def test_the_references_world_slides_and_grows_alike() -> None:
    document = {"scene": "shells", "surface": {"kind": "plane"}, "course": {"keys": [{"slide_u": 0.25, "growth": 0.5}]}}
    state = validate(ShellsState, document)
    cache = Cache()
    baked = {bake.name: bake_now(bake, cache) for bake in bakes(state)}
    now = world_arrays(state, baked)
    still = world_arrays(validate(ShellsState, {**document, "course": {}}), baked)
    np.testing.assert_allclose(now["texture"] - still["texture"], np.broadcast_to((0.25, 0, 0), now["texture"].shape))
    assert now["colour"][..., 3].sum() < 0.8 * still["colour"][..., 3].sum()


def test_opacity_thins_all_matter_alike(draw: Draw) -> None:
    """A key frame of half the opacity has half the optical depth, and the reference's world likewise."""
    thick, thin = even(0.3), {"course": {"keys": [{"opacity": 0.5}]}}
    passed = 1 - draw({}, thick)[..., 3]
    np.testing.assert_allclose(1 - draw(thin, thick)[..., 3], np.sqrt(passed), rtol=1e-4)
    for sampling in ({"kind": "quantiles", "jitter": 0.0}, {"kind": "dda"}):
        np.testing.assert_allclose(
            1 - draw({**thin, "sampling": sampling}, thick)[..., 3], np.sqrt(passed), rtol=0.02, err_msg=str(sampling)
        )
    document = {"scene": "shells", "surface": {"kind": "plane"}, "texture": {"kind": "uniform"}}
    cache = Cache()
    baked = {bake.name: bake_now(bake, cache) for bake in bakes(validate(ShellsState, document))}
    states = [validate(ShellsState, {**document, **patch}) for patch in ({}, thin)]
    lengths = [world_arrays(state, baked)["reference_length"] for state in states]
    assert lengths[1] == pytest.approx(2 * lengths[0])


def test_before_the_first_key_frame_comes_what_follows_the_last() -> None:
    for times, period, time, expected in (
        ((1.0, 3.0), 4.0, 0.5, (1, 0, 0.75)),
        ((1.0, 3.0), 4.0, 3.5, (1, 0, 0.25)),
        ((1.0, 3.0), 4.0, 2.0, (0, 1, 0.5)),
        ((1.0, 4.0), 4.0, 0.25, (1, 0, 0.25)),
        ((2.0,), 4.0, 3.0, (0, 0, 0.25)),
        ((1.0, 1.0, 3.0), 4.0, 1.0, (1, 2, 0.0)),
    ):
        assert between(times, period, time) == pytest.approx(expected), (times, time)
