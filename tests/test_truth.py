"""From a state to its reference, and a picture beside it."""

from __future__ import annotations

import io
import math
from typing import Any

import numpy as np
import pytest
from PIL import Image

from renderer import comparing, truth
from renderer.clouds.phenomenon import PHENOMENON as CLOUDS
from renderer.core.baking import bake_key
from renderer.core.errors import Cancelled, InputError
from renderer.core.params import validate
from renderer.forest.phenomenon import PHENOMENON
from renderer.forest.state import ForestState
from renderer.picture import Picture
from renderer.reference.forest_world import ForestWorld
from renderer.truth import POSITIONS, bake_truth, truth_bake, truth_of
from renderer.world.sampling import offsets
from renderer.world.sky import VIEW_SHAPE, sky_for, sky_sun_disc
from renderer.world.state import View
from tests.reference.worlds import flat

E_SUN, E_SKY_RADIANCE = (900.0, 800.0, 700.0), 20.0
DOWN = {"kind": "orthographic", "centre": [0, 0, 0], "direction": [0, 0, -1], "up": [0, 1, 0], "width": 40}
QUIET = lambda share, words: None  # noqa: E731


def state(**patch: Any) -> ForestState:
    patch["ground"] = {"patches": 0.0, **patch.get("ground", {})}  # an even meadow has a closed form
    made = validate(ForestState, {"scene": "forest", "camera": DOWN, **patch})
    assert isinstance(made, ForestState)
    return made


def baked(alpha: int = 0, cover: float = 0.0) -> dict[str, dict[str, np.ndarray]]:
    """A level meadow, or a wood of one opacity, under a sky of one radiance."""
    world = flat(alpha)
    suns = np.radians([-18.0, 0.0, 90.0])
    return {
        "terrain": {"elevation": world.elevation, "cover": np.full_like(world.cover, cover),
                    "presence": np.full_like(world.cover, 255 * cover), "growth": np.ones_like(world.cover)},
        "pattern": {name: getattr(world, name) for name in ("colour", "normal", "anchor", "tile")},
        "sky": {
            "elevations": suns,
            "sun_irradiance": np.tile(E_SUN, (3, 1)),
            "sky_irradiance": np.full((3, 3), math.pi * E_SKY_RADIANCE),
            "radiance": np.full((3, *VIEW_SHAPE, 3), E_SKY_RADIANCE, np.float32),
        },
    }


def made(of: ForestState, inputs: dict[str, Any], width: int = 6, height: int = 4, progress: Any = QUIET,
         judge: Any = "share") -> Any:
    return truth_of(bake_truth(truth_bake(of, width, height, judge).arguments, inputs, progress))


@pytest.mark.parametrize(("elevation", "spoiled"), [(90.0, False), (30.0, False), (30.0, True)])
def test_a_meadow_sends_back_what_the_closed_form_says(elevation: float, spoiled: bool) -> None:
    of = state(sun={"kind": "direction", "azimuth": 40, "elevation": elevation})
    found = made(of, baked())
    share = 1.0 if spoiled else math.sin(math.radians(elevation))
    expected = np.array(of.ground.albedo) / math.pi * (np.array(E_SUN) * share + math.pi * E_SKY_RADIANCE)
    close = np.allclose(found.linear[..., :3], expected, rtol=1e-3)
    assert close is not spoiled
    assert found.linear.shape == (4, 6, 4)
    assert found.linear[..., 3] == pytest.approx(1.0)
    assert found.once == pytest.approx(found.linear)
    assert found.standard_error == 0


def test_a_meadow_under_rays_to_the_sky_is_as_bright_as_under_its_whole_light() -> None:
    of = state(sun={"kind": "direction", "azimuth": 40, "elevation": 30})
    found, even = made(of, baked(), judge="combination"), made(of, baked())
    assert 0 < found.standard_error < 0.1
    # 24 pixels of 160 rays each, in which the cosine alone is uncertain
    assert found.linear.mean() == pytest.approx(even.linear.mean(), rel=5e-3)
    assert not np.array_equal(found.linear, even.linear)


def test_the_world_of_a_state_is_complete() -> None:
    world = PHENOMENON.world(state(), baked(200, 1.0))
    background = world.pop("background")
    assert background(np.array([[0.0, 0.6, 0.8]])) == pytest.approx(E_SKY_RADIANCE)
    forest = ForestWorld(**world)
    assert forest.e_sky == pytest.approx((math.pi * E_SKY_RADIANCE,) * 3, rel=1e-3)


def test_a_view_over_the_horizon_sees_only_the_backdrop() -> None:
    up = {"kind": "look", "eye": [0, 0, 50], "target": [0, 10, 80], "up": [0, 0, 1], "field_of_view": 20}
    found = made(state(camera=up, sun={"kind": "direction", "azimuth": 180, "elevation": 40}), baked())
    assert not found.linear.any()
    assert found.backdrop == pytest.approx(E_SKY_RADIANCE, rel=1e-5)


def test_the_suns_disc_is_as_wide_as_the_sun() -> None:
    now = sky_for(baked()["sky"], math.radians(40))
    sun = np.array([0.0, math.cos(math.radians(40)), math.sin(math.radians(40))])
    near = [np.array([0.0, math.cos(a), math.sin(a)]) for a in np.radians([40.0, 40.26, 40.28])]
    inside = sky_sun_disc(now, sun, np.array(near))[:, 0] > 0
    assert inside.tolist() == [True, True, False]


def key(of: ForestState, *options: Any) -> str:
    return bake_key(truth_bake(of, *(options or (64, 64))))


def test_techniques_and_view_have_no_part_in_a_reference() -> None:
    same = [
        state(shadow={"kind": "none"}, geometry={"kind": "slices"}),
        state(view={"exposure": 2, "background": "white"}),
        state(quality={"kind": "draft"}),
        state(light={"kind": "gouraud"}),
    ]
    assert {key(of) for of in same} == {key(state())}


def test_whatever_is_seen_has_a_part_in_it() -> None:
    plain = state()
    others = [
        key(state(sun={"kind": "direction", "azimuth": 1, "elevation": 40})),
        key(state(camera={**DOWN, "width": 41})),
        key(state(cover={"seed": 8})),
        key(state(canopy={"seed": 2})),
        key(state(ground={"tint_strength": 0.1})),
        key(plain, 65, 64),
        key(state(light={"kind": "gouraud"}), 64, 64, "shadow"),
    ]
    assert len({key(plain), *others}) == len(others) + 1
    assert key(plain, 64, 64, "shadow") == key(plain, 64, 64, "share") != key(plain)
    other = state(sky={"kind": "constant"})
    assert key(other, 64, 64, "shadow") == key(other) == key(plain), "the sky's light is exact where none is shared"


def test_of_clouds_time_and_droplets_have_a_part_in_it() -> None:
    def clouds(**patch: Any) -> str:
        return bake_key(truth_bake(validate(CLOUDS.state, {"scene": "clouds", **patch}), 32, 32))

    plain = clouds()
    same = [
        clouds(phase={"kind": "rayleigh"}),
        clouds(scattering={"kind": "single"}, geometry={"kind": "flat"}, bounce={"kind": "none"}),
        clouds(view={"exposure": 2}),
    ]
    others = [
        clouds(time=60.0),
        clouds(phase={"kind": "mie", "radius": 12.0}),
        clouds(layer={"thickness": 90.0}),
        clouds(sun={"kind": "direction", "azimuth": 1, "elevation": 40}),
    ]
    assert set(same) == {plain}
    assert len({plain, *others}) == len(others) + 1
    assert key(state(time=60.0)) == key(state()), "forests do not drift"


def test_only_the_code_that_a_reference_reads_is_in_its_key(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    texts = {"forest": "from renderer.reference.forest_a import x", "forest_a": "x = 1", "clouds": "y = 1"}
    for name, text in texts.items():
        (tmp_path / f"{name}.py").write_text(text)
    monkeypatch.setattr(truth.reference, "__path__", [str(tmp_path)])

    def code() -> str:
        truth.code_of_reference.cache_clear()
        return truth.code_of_reference("forest")

    before = code()
    (tmp_path / "clouds.py").write_text("y = 2")
    assert code() == before, "another scene's"
    (tmp_path / "forest_a.py").write_text("x = 2")
    assert code() != before, "what it imports"
    truth.code_of_reference.cache_clear()


def test_progress_reaches_the_end_and_may_stop_it() -> None:
    told: list[float] = []
    made(state(), baked(200, 1.0), progress=lambda share, words: told.append(share))
    assert told == sorted(told)
    assert told[-1] == pytest.approx(1.0)

    def stop(share: float, words: str) -> None:
        if share > 0.3:
            raise Cancelled("enough")

    with pytest.raises(Cancelled):
        made(state(), baked(200, 1.0), progress=stop)


class Drawing:
    """A session whose pictures are a multiple of the reference."""

    def __init__(self, of: ForestState, gain: float, inputs: dict[str, Any]) -> None:
        self.gain = gain
        self.arrays = bake_truth(truth_bake(of, 12, 8).arguments, inputs, QUIET)
        self.places: list[tuple[float, float]] = []
        self.backgrounds: list[str] = []

    def compute(self, bake: Any, on_progress: Any) -> Any:
        assert bake.name == "reference"
        return self.arrays

    def draw(self, of: ForestState, width: int, height: int, samples: int, place: Any = None) -> Picture:
        self.backgrounds.append(of.view.background)
        if place is not None:
            self.places = [place(n) for n in range(samples)]
        linear = (self.arrays["linear"] * self.gain).astype(np.float32)
        linear[..., 3] = self.arrays["linear"][..., 3]
        return Picture(linear, np.zeros((8, 12, 3), np.uint8), samples, 1.0)

    def exposure_ev(self, of: ForestState) -> float:
        return -6.5


@pytest.mark.parametrize(("gain", "error"), [(1.0, 0.0), (2.0, 1.0)])
def test_a_comparison_has_files_and_numbers(gain: float, error: float) -> None:
    of = state(sun={"kind": "direction", "azimuth": 180, "elevation": 40})
    session: Any = Drawing(of, gain, baked())
    told: list[Any] = []
    found = comparing.compare(session, of, 12, 8, told.append)
    # the meadow's channels differ: the error relative to the mean is their quadratic mean
    colour = session.arrays["linear"][..., :3]
    expected = error * float(np.sqrt(np.mean(colour**2)) / colour.mean())
    assert found.numbers["relative_rmse"] == pytest.approx(expected, abs=1e-6)
    assert found.numbers["relative_rmse_after_gain"] == pytest.approx(0, abs=1e-6)
    assert found.numbers["gain"] == pytest.approx(1 / gain)
    assert (found.numbers["flip_mean"] == 0) is (gain == 1)
    assert found.numbers["size"] == [12, 8]
    assert len(found.numbers["legend"]) == 5
    for name in ("reference.png", "picture.png", "error.png"):
        assert Image.open(io.BytesIO(found.files[name])).size == (12, 8)
    assert (found.files["reference.png"] == found.files["picture.png"]) is (gain == 1)
    assert set(session.backgrounds) == {"none"}
    assert session.places == [tuple(p) for p in offsets(POSITIONS)] * comparing.PASSES
    assert told[-1].fraction == comparing.REFERENCE_SHARE


def test_a_reference_of_nothing_is_refused() -> None:
    up = {"kind": "look", "eye": [0, 0, 50], "target": [0, 10, 80], "up": [0, 0, 1], "field_of_view": 20}
    of = state(camera=up, sun={"kind": "direction", "azimuth": 180, "elevation": 40})
    session: Any = Drawing(of, 1.0, baked())
    with pytest.raises(InputError) as refused:
        comparing.compare(session, of, 12, 8)
    assert refused.value.field == "reference"


@pytest.mark.parametrize(("background", "shown"), [("sky", 188), ("none", 137), ("white", 225)])
def test_what_lies_behind_shows_through(background: Any, shown: int) -> None:
    half = np.full((1, 1, 4), 0.25)
    half[..., 3] = 0.5
    view = View(tone_curve="linear", background=background)
    found = comparing.displayed(half, view, 0.0, np.full((1, 1, 3), 0.5))
    assert found[0, 0] == pytest.approx(shown, abs=1)
    assert comparing.displayed(half, view, 0.0)[0, 0] == pytest.approx(137, abs=1)
