"""Holds techniques to the forest's reference on the grove, and their pictures to frozen ones.

A missing reference fails the test and leaves a candidate under `out/references`; `pytest --regenerate` puts what was
found in its place instead.
"""

from __future__ import annotations

import json
import math
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
import pytest

from renderer import view
from renderer.core.baking import bake_key, bake_now
from renderer.core.cache import Cache
from renderer.core.technique import BakedArrays
from renderer.forest.state import ForestState
from renderer.forest.world_arrays import world_arrays
from renderer.gl.thread import GLThread
from renderer.reference.forest import Options, Reference, render
from renderer.reference.forest_world import ForestWorld
from renderer.study.metrics import relative_rmse
from renderer.world.camera import rays
from renderer.world.image import save_image
from renderer.world.sampling import offset, offsets
from tests.forest import worlds

ROOT = Path(__file__).parent.parent.parent
REFERENCES = Path("tests/references/forest")
CANDIDATES = Path("out/references/forest")

SIDE = 64
"""Pixels a side of what is compared with the reference."""

POSITIONS = 8
"""Sub-pixel positions, the same for technique and reference."""

TURNS = 16
"""Jitters at each position, so that a technique's picture is converged and speaks of the method alone."""

SHOWN = 96
STRAY = 0.005
"""Share of a frozen picture's values that may be off: rays that a rounding sends past the other side of a leaf."""

MARCH = 0.016
"""Relative RMSE of marching itself, without shadows: steps of one voxel, and nearest voxels at random offsets in the
place of trilinear ones. What another technique costs comes on top."""

SKY = (0.2, 0.26, 0.38)
SCENE: dict[str, Any] = {
    "camera": {"kind": "orbit", "target": [10, 0, 30], "distance": 150, "azimuth": 200, "elevation": 32,
               "field_of_view": 40},
    "sun": worlds.sun(245, 33),
    "ground": {"tint_strength": 0.2, "patches": 0.2, "albedo": [0.12, 0.1, 0.05],
               "translucency": 0.7},
    "view": {"exposure": 2.0},
}
REFERENCE_OPTIONS = {
    "full": Options(shadow_rays=8),
    "unshadowed": Options(terrain=False, forest_on_ground=False, tree_on_tree=False, within_tree=False),
    "sky": Options(terrain=False, forest_on_ground=False, tree_on_tree=False, within_tree=False, sky="hemisphere"),
}


class Judge:
    """Draws the grove with one technique in its place, and says how far that is from the truth.

    Args:
        thread, painter: where and by whom it is drawn. regenerate: whether to replace what is frozen.
    """

    def __init__(self, thread: GLThread, painter: view.Painter, regenerate: bool) -> None:
        self._thread = thread
        self._painter = painter
        self._regenerate = regenerate
        self._new: set[str] = set()

    def holds(self, slot: str, kind: str, *costs: float, against: str = "unshadowed", **others: Any) -> None:
        """Assert that a technique's converged picture is within its budget of the reference.

        Args:
            costs: relative RMSE that each approximation was measured to add, one by one; the budget is their sum and a
                tenth, for what another rasteriser rounds otherwise.
            against, others: as for `distance`.
        """
        found, budget = self.distance(slot, kind, against, **others), 1.1 * sum(costs)
        assert found <= budget

    def distance(self, slot: str, kind: str, against: str = "unshadowed", **others: Any) -> float:
        """Relative RMSE of the converged picture, over the colours.

        Args:
            against: `full`, `unshadowed` for what does not know shadows, or `sky` likewise with the sky's light exact.
            others: what else differs from the plain techniques, by slot.
        """
        made = worlds.state(**{**SCENE, **worlds.with_technique(slot, kind), **others})
        return relative_rmse(self.converged(made)[..., :3], self.truth(against)[..., :3])

    def converged(self, made: ForestState) -> np.ndarray:
        """A state's picture at the reference's positions, its jitter averaged, (SIDE, SIDE, 4) float64."""
        found = view.paint(self._thread, self._painter, made, grove(made), (SIDE, SIDE), POSITIONS * TURNS,
                           place=lambda sample: offset(sample % POSITIONS))
        return found.linear.astype(np.float64)

    def truth(self, name: str) -> np.ndarray:
        """The frozen reference, (SIDE, SIDE, 4) float64, W m-2 sr-1."""
        found = self._frozen(f"grove_{name}.npz", lambda path: _write_reference(path, name))
        with np.load(found) as kept:
            recipe = json.loads(str(kept["recipe"]))
            assert recipe["world"] == worlds.VERSION, "the grove changed: its reference is of another world"
            return kept["radiance"].astype(np.float64)

    def looks(self, slot: str, kind: str) -> None:
        """Assert that a small picture is the frozen one to 1/255, or merely a picture on another rasteriser."""
        made = worlds.state(**{**SCENE, **worlds.with_technique(slot, kind)})
        seen = view.paint(self._thread, self._painter, made, grove(made), (SHOWN, SHOWN), 4)
        assert np.isfinite(seen.linear).all()
        assert seen.rgb8.std() > 5, "there is nothing to see"
        if "llvmpipe" not in self._thread.info.renderer:
            return
        path = self._frozen(f"{slot}_{kind}.png", lambda to: to.write_bytes(save_image("png", seen.rgb8)))
        frozen = np.asarray(PIL.Image.open(path).convert("RGB"), np.int16)
        assert (np.abs(seen.rgb8 - frozen) > 1).mean() <= STRAY

    def _frozen(self, name: str, write: Callable[[Path], Any]) -> Path:
        path = ROOT / REFERENCES / name
        if not path.is_file() or (self._regenerate and name not in self._new):
            to = path if self._regenerate else ROOT / CANDIDATES / name
            to.parent.mkdir(parents=True, exist_ok=True)
            write(to)
            self._new.add(name)
            if not self._regenerate:
                pytest.fail(f"there is no {REFERENCES / name}; a candidate lies in {CANDIDATES}")
        return path


def grove(made: ForestState) -> dict[str, BakedArrays]:
    """The grove's bakes for a state, from the tests' cache: what its techniques ask for, over the grove."""
    wanted = [worlds.GROVE_GROUND, worlds.GROVE_PATTERN]
    for technique in made.techniques().values():
        wanted += technique.bakes(made, worlds.GROVE_GROUND, worlds.GROVE_PATTERN)
    found = {bake.name: _baked(bake) for bake in wanted}
    return {**found, **worlds.together(sky=worlds.sky(SKY))}


KEPT: dict[str, BakedArrays] = {}


def _baked(bake: Any) -> BakedArrays:
    key = bake_key(bake)
    if key not in KEPT:
        KEPT[key] = BakedArrays(key, bake_now(bake, Cache()))
    return KEPT[key]


def grove_world(made: ForestState) -> ForestWorld:
    """The grove as the reference takes it."""
    arrays = {name: entry.arrays for name, entry in grove(made).items()}
    return replace(ForestWorld(**world_arrays(made, arrays)), background=None)


def reference(name: str) -> tuple[Reference, dict[str, Any]]:
    """March the grove's reference, and say how."""
    made = worlds.state(**{**SCENE, **worlds.PLAIN})
    found = render(grove_world(made), lambda place: rays(made.camera, SIDE, SIDE, place), offsets(POSITIONS),
                   REFERENCE_OPTIONS[name])
    commit = subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True, text=True).stdout
    recipe = {
        "by": "pytest --regenerate tests/forest", "world": worlds.VERSION, "commit": commit.strip() or "unknown",
        "seed": REFERENCE_OPTIONS[name].seed, "samples": POSITIONS, "unit": "W m-2 sr-1",
        "relative_standard_error": found.relative_error, "options": repr(REFERENCE_OPTIONS[name]),
    }
    assert math.isfinite(found.relative_error)
    return found, recipe


def _write_reference(path: Path, name: str) -> None:
    found, recipe = reference(name)
    np.savez_compressed(path, radiance=found.radiance.astype(np.float32),
                        standard_error=found.standard_error.astype(np.float32), recipe=np.array(json.dumps(recipe)))
