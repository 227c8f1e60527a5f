"""Holds every shadow technique to the reference in views that isolate one kind of shadow each: error, flicker, cost.

A phenomenon lists its views and techniques in `renderer/<name>/isolating.py`, as `ISOLATIONS`, `COMMON` and
`contenders`; nothing else changes for a new one.
"""

from __future__ import annotations

import importlib
import importlib.util
import math
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import renderer
from renderer.benching import STEP_DEGREES
from renderer.comparing import PASSES, displayed, place, truth
from renderer.core.baking import bake_key
from renderer.core.cache import key_of
from renderer.core.channel import Progress
from renderer.core.errors import Cancelled, InputError, UmbrageError
from renderer.core.isolation import Contender, Isolation
from renderer.core.registry import SHADERS, phenomenon
from renderer.study.metrics import flip, relative_rmse
from renderer.study.stability import STEPS, flicker
from renderer.study.sweep import append, read
from renderer.truth import POSITIONS, Truth, code_of, truth_bake, truth_of
from renderer.world.state import SceneState
from renderer.world.sun import SunDirection, angles

if TYPE_CHECKING:
    from renderer.session import Session

Tell = Callable[[float, str], None]

THRESHOLD = 0.1
"""Change by one kind of shadow alone, of the unshadowed picture's mean, from which a pixel belongs to that kind."""

SHARED_SIZE = 24
"""Side of the pictures, pixels, in which the kinds' shares are found: each kind costs a reference there."""

MOVING_PASSES = 4
"""Samples at each of the reference's positions while the sun moves: their jitter is the same at every place of the sun,
so that less of it remains in a difference than in a picture."""


@dataclass(frozen=True)
class Plan:
    """What is compared.

    Attributes:
        scene: its name.
        size: side of the pictures, pixels. moving: of those in which the sun moves, of which there are many.
        steps: of the moving sun.
    """

    scene: str
    size: int = 64
    moving: int = 64
    steps: int = STEPS

    def checked(self) -> Plan:
        """The plan, of a scene that has such views.

        Raises:
            InputError: naming the option.
        """
        if importlib.util.find_spec(f"renderer.{phenomenon(self.scene).name}.isolating") is None:
            raise InputError("scene", f"{self.scene} isolates no kinds of shadow")
        for option, side in (("size", self.size), ("moving", self.moving)):
            if not 16 <= side <= 256:
                raise InputError(option, f"{side} px are not studied", "16 to 256: the reference runs on the CPU")
        if not 1 <= self.steps <= 64:
            raise InputError("steps", f"{self.steps} cannot be swept", "1 to 64")
        return self

    @property
    def isolations(self) -> tuple[Isolation, ...]:
        """The views."""
        return tuple(importlib.import_module(f"renderer.{self.scene}.isolating").ISOLATIONS)

    @property
    def contenders(self) -> tuple[Contender, ...]:
        """The techniques."""
        return tuple(importlib.import_module(f"renderer.{self.scene}.isolating").contenders())

    @property
    def common(self) -> Mapping[str, Any]:
        """Documents of the slots that all shadow techniques share."""
        return dict(importlib.import_module(f"renderer.{self.scene}.isolating").COMMON)


def state_with(session: Session, plan: Plan, preset: str, contender: Contender) -> SceneState:
    """A view with a contender's techniques; the parameters that it leaves out take the techniques' own defaults."""
    document = session.state(plan.scene, preset).model_dump(mode="json")
    document |= contender.patch if contender.combination else {**plan.common, **contender.patch}
    return session.validate(document)


def change(shaded: NDArray[np.floating], bare: NDArray[np.floating]) -> NDArray[np.float64]:
    """By how much shadow changes each pixel, mean over the channels, of the unshadowed picture's mean."""
    apart = np.abs(shaded[..., :3].astype(np.float64) - bare[..., :3])
    return np.asarray(apart.mean(axis=-1) / float(bare[..., :3].mean()))


@dataclass
class KindStudy:
    """One table under way, which keeps the references and masks of a view.

    Attributes:
        session: draws, bakes and caches. plan: checked. tell: told the share done.
    """

    session: Session
    plan: Plan
    tell: Tell | None = None
    _truths: dict[str, list[Truth]] = field(default_factory=dict)
    _at: float = 0.0

    def mask(self, isolation: Isolation, size: int) -> NDArray[np.bool_]:
        """Pixels that belong to a kind of shadow; all that show the scene where the view isolates none."""
        bare = self._cast(isolation, (), size)
        found = np.asarray(bare[..., 3] > 0.5)
        if isolation.switch:
            found = change(self._cast(isolation, (isolation.switch,), size), bare) > THRESHOLD
        if not found.any():
            raise InputError("size", f"no pixel of {isolation.preset} shows {isolation.title} at {size} px", "larger")
        return found

    def shares(self, isolation: Isolation) -> dict[str, float]:
        """Share of each kind, cast alone, in what changes within the mask of one."""
        size = min(SHARED_SIZE, self.plan.size)
        bare, mask = self._cast(isolation, (), size), self.mask(isolation, size)
        kinds = [other.switch for other in self.plan.isolations if other.switch]
        every = {kind: change(self._cast(isolation, (kind,), size), bare)[mask] for kind in kinds}
        found = {one.name: float(every[one.switch].sum()) for one in self.plan.isolations if one.switch}
        whole = sum(found.values())
        return {name: amount / whole if whole > 0 else 0.0 for name, amount in found.items()}

    def measure(self, results: Path, machine: Mapping[str, Any]) -> list[dict[str, Any]]:
        """Error and flicker of every contender in every view that has no result yet."""
        lines = [line for line in read(results) if line["kind"] == "shadow_kind" and "failed" not in line]
        known = {line["key"]: line for line in lines}
        found = []
        contenders = self.plan.contenders
        for column, isolation in enumerate(self.plan.isolations):
            for row, contender in enumerate(contenders):
                self._at = (column + row / len(contenders)) / len(self.plan.isolations)
                self._say(f"{isolation.name}: {contender.label}")
                states = self._places(isolation, contender)
                key = self._key(isolation, states)
                if key not in known:
                    known[key] = {
                        "kind": "shadow_kind", "key": key, "scene": self.plan.scene, "column": isolation.name,
                        "preset": isolation.preset, "sun": "preset", "label": contender.label, "seed": 0,
                        "parameters": dict(contender.patch), "combination": contender.combination,
                        "size": [self.plan.size] * 2, "moving": [self.plan.moving] * 2, "steps": self.plan.steps,
                        **self._line(isolation, states), "machine": dict(machine), "when": int(time.time()),
                    }  # fmt: skip
                    append(results, known[key])
                # two contenders may mean the same techniques: what is measured once counts for both
                own = {"label": contender.label, "combination": contender.combination}
                found.append({**known[key], **own, "parameters": dict(contender.patch)})
            self._truths.clear()
        return found

    def masks(self, results: Path, machine: Mapping[str, Any]) -> list[dict[str, Any]]:
        """How much of each view belongs to its kind, and what else falls there."""
        known = {line["key"]: line for line in read(results) if line["kind"] == "mask"}
        found = []
        for isolation in filter(lambda one: one.switch, self.plan.isolations):
            size = self.plan.size
            cast = bake_key(truth_bake(self._bare(isolation), size, size, "shadow", (isolation.switch,)))
            key = key_of("mask", asdict(isolation), cast, THRESHOLD, SHARED_SIZE)
            if key not in known:
                self._say(f"{isolation.name}: which pixels it has")
                mask = float(self.mask(isolation, size).mean())
                known[key] = {"kind": "mask", "key": key, "column": isolation.name, "preset": isolation.preset,
                              "covers": mask, "shares": self.shares(isolation), "size": [size] * 2,
                              "machine": dict(machine), "when": int(time.time())}  # fmt: skip
                append(results, known[key])
            found.append(known[key])
        return found

    def _line(self, isolation: Isolation, states: list[SceneState]) -> dict[str, Any]:
        """The numbers of one contender in one view; a technique that this machine cannot draw has `failed`."""
        begun = time.perf_counter()
        try:
            still, *moving = self._references(isolation)
            mask = self.mask(isolation, self.plan.size)
            picture = self._drawn(states[0], self.plan.size, PASSES)
            pictures = [self._drawn(state, self.plan.moving, MOVING_PASSES) for state in states]
        except Cancelled:
            raise
        except UmbrageError as failure:
            return {"failed": str(failure)}
        exposure = self.session.exposure_ev(states[0])
        shown = [displayed(linear, states[0].view, exposure) for linear in (picture, still.linear)]
        # pictures one row high: the measures see the masked pixels alone
        within = self.mask(isolation, self.plan.moving)
        steady = flicker([one[within][None] for one in pictures], [one.linear[within][None] for one in moving])
        return {
            "covers": float(mask.mean()),
            "relative_rmse": relative_rmse(picture[mask][None], still.linear[mask][None]),
            "flip_mean": float(flip(shown[0], shown[1]).map[mask].mean()),
            "flicker": steady.value, "flicker_worst": steady.worst, "truth_moves": steady.truth,
            "reference_standard_error": still.standard_error, "reference_seconds": still.seconds,
            "took_seconds": time.perf_counter() - begun,
        }  # fmt: skip

    def _drawn(self, state: SceneState, size: int, passes: int) -> NDArray[np.floating]:
        bare = state.model_copy(update={"view": state.view.model_copy(update={"background": "none"})})
        return self.session.draw(bare, size, size, POSITIONS * passes, place).linear

    def _places(self, isolation: Isolation, contender: Contender) -> list[SceneState]:
        """A contender's states while the sun moves on."""
        first = state_with(self.session, self.plan, isolation.preset, contender)
        azimuth, elevation = (math.degrees(angle) for angle in angles(first.sun))
        suns = [SunDirection(azimuth=(azimuth + STEP_DEGREES * turn) % 360, elevation=elevation)
                for turn in range(self.plan.steps + 1)]  # fmt: skip
        return [first.model_copy(update={"sun": sun}) for sun in suns]

    def _bare(self, isolation: Isolation) -> SceneState:
        return state_with(self.session, self.plan, isolation.preset, Contender("", {}))

    def _references(self, isolation: Isolation) -> list[Truth]:
        """The reference of a view, and those while its sun moves on: all shadows exact, on leaves."""
        if isolation.name not in self._truths:
            made = []
            for number, (state, size) in enumerate(self._judged(self._places(isolation, Contender("", {})))):
                words = f"{isolation.name}: reference {number + 1} of {self.plan.steps + 2}"
                made.append(truth(self.session, state, size, size, "shadow", self._inner(words)))
            self._truths[isolation.name] = made
        return self._truths[isolation.name]

    def _judged(self, states: list[SceneState]) -> list[tuple[SceneState, int]]:
        """States and sizes of the references: the first one's own, then those of the sweep."""
        return [(states[0], self.plan.size), *((state, self.plan.moving) for state in states)]

    def _cast(self, isolation: Isolation, cast: tuple[str, ...], size: int) -> NDArray[np.float64]:
        """The reference's picture of a view under some kinds of shadow."""
        bake = truth_bake(self._bare(isolation), size, size, "shadow", cast)
        words = f"{isolation.name}: {', '.join(cast) or 'no shadow'}"
        return truth_of(self.session.compute(bake, self._inner(words))).linear

    def _key(self, isolation: Isolation, states: list[SceneState]) -> str:
        """Changes when a picture, a reference or the mask may."""
        here = Path(renderer.__path__[0])
        code = code_of(SHADERS, here / self.plan.scene, here / "world", here / "gl")
        bakes = [bake_key(bake) for bake in phenomenon(self.plan.scene).bakes(states[0])]
        truths = [bake_key(truth_bake(state, size, size, "shadow")) for state, size in self._judged(states)]
        drawn = [state.model_dump(mode="json") for state in states]
        return key_of("shadow_kind", asdict(isolation), code, bakes, truths, drawn, PASSES, MOVING_PASSES, THRESHOLD)

    def _inner(self, words: str) -> Callable[[Progress], None]:
        return lambda progress: self._say(f"{words}, {progress.fraction:.0%}")

    def _say(self, words: str) -> None:
        if self.tell is not None:
            self.tell(self._at, words)
