"""Sweeps a scene by small steps and measures how steadily its techniques follow: the sun, the camera, a parameter."""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import renderer
from renderer.choices import Choice
from renderer.comparing import PASSES, converged, displayed, truth
from renderer.core.baking import bake_key
from renderer.core.cache import key_of
from renderer.core.errors import InputError, InvalidDocument
from renderer.core.registry import SHADERS, phenomenon
from renderer.study.stability import STEPS, WIDTH, Flicker, flicker, strip, write
from renderer.study.sweep import append, provenance, read
from renderer.truth import Truth, code_of, truth_bake
from renderer.world.camera import Look, Orbit, pose
from renderer.world.image import save_image
from renderer.world.state import SceneState
from renderer.world.sun import SunDirection, angles

if TYPE_CHECKING:
    from renderer.session import Session

Tell = Callable[[float, str], None]

SUN_STEP = 0.25
"""Degrees that the sun moves from one frame to the next."""

CAMERA_STEP = 0.001
"""Share of its distance that the camera moves from one frame to the next."""

PARAMETER_STEP = 0.01
"""Share of itself that a parameter moves from one frame to the next; as much outright where it is 0."""

RISE = -1.0
"""Elevation [deg] from which the sun's elevation is swept: through the horizon."""

SWEEPS = ("sun_azimuth", "sun_elevation", "camera")

ASPECT = 9 / 16
"""Height of the pictures over their width."""


@dataclass(frozen=True)
class Plan:
    """What is swept, and what is compared.

    Attributes:
        scene, preset: names. sweep: one of `SWEEPS`, or the path of a number in the document.
        slot: whose techniques are compared. choices: those.
        sets: what else differs from the preset, by path.
        width: of the pictures, pixels; figures are stated at 128. steps: of the sweep; figures are stated for 16.
        stride: how many steps are taken at once; figures are stated for one.
    """

    scene: str
    preset: str
    sweep: str
    slot: str = "shadow"
    choices: tuple[Choice, ...] = ()
    sets: Mapping[str, Any] = field(default_factory=dict)
    width: int = WIDTH
    steps: int = STEPS
    stride: float = 1.0

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, pixels."""
        return self.width, max(1, round(self.width * ASPECT))

    def checked(self) -> Plan:
        """The plan, which makes sense.

        Raises:
            InputError: naming the option.
        """
        slots = tuple(slot.name for slot in phenomenon(self.scene).slots)
        if self.slot not in slots:
            raise InputError("slot", f"{self.scene} has no slot {self.slot}", ", ".join(slots))
        if not 16 <= self.width <= 256:
            raise InputError("width", f"{self.width} px are not studied", "16 to 256: the reference runs on the CPU")
        if not 1 <= self.steps <= 64:
            raise InputError("steps", f"{self.steps} cannot be swept", "1 to 64")
        return self


def places(session: Session, plan: Plan) -> list[SceneState]:
    """The states of a sweep, one more than its steps, with the slot's own technique.

    Raises:
        InputError, InvalidDocument: a sweep that the scene cannot make.
    """
    first = session.state(plan.scene, plan.preset, plan.sets)
    if plan.sweep == "camera":
        return [_aside(first, turn * CAMERA_STEP * plan.stride) for turn in range(plan.steps + 1)]
    if plan.sweep in SWEEPS:
        azimuth, elevation = (math.degrees(angle) for angle in angles(first.sun))
        turns = SUN_STEP * plan.stride * np.arange(plan.steps + 1)
        if plan.sweep == "sun_azimuth":
            suns = [SunDirection(azimuth=float((azimuth + t) % 360), elevation=elevation) for t in turns]
        else:
            suns = [SunDirection(azimuth=azimuth, elevation=float(RISE + t)) for t in turns]
        return [first.model_copy(update={"sun": sun}) for sun in suns]
    return [session.state(plan.scene, plan.preset, {**plan.sets, plan.sweep: value}) for value in _values(first, plan)]


def _values(state: SceneState, plan: Plan) -> list[float]:
    value: Any = state.model_dump(mode="json")
    for name in plan.sweep.split("."):
        if not isinstance(value, dict) or name not in value:
            raise InputError("sweep", f"{plan.sweep} is nothing to sweep", f"{', '.join(SWEEPS)}, or a number's path")
        value = value[name]
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError("sweep", f"{plan.sweep} is no number", f"{', '.join(SWEEPS)}, or a number's path")
    step = PARAMETER_STEP * plan.stride * (abs(value) or 1.0)
    return [float(value + turn * step) for turn in range(plan.steps + 1)]


def _aside(state: SceneState, share: float) -> SceneState:
    """The state with its camera moved to the right by a share of its distance (of its width, seen in parallel)."""
    camera: Any = state.camera
    names: tuple[str, ...]
    if isinstance(camera, Orbit):
        names, distance = ("target",), camera.distance
    elif isinstance(camera, Look):
        names, distance = ("eye", "target"), math.dist(camera.eye, camera.target)
    else:
        names, distance = ("centre",), camera.width
    move = share * distance * pose(camera).right
    moved = {name: tuple(map(float, np.add(getattr(camera, name), move))) for name in names}
    return state.model_copy(update={"camera": camera.model_copy(update=moved)})


def with_choice(session: Session, plan: Plan, state: SceneState, choice: Choice) -> SceneState:
    """A place of a sweep with a technique in the slot that is studied.

    Raises:
        InputError: the technique has no such parameter.
    """
    document = state.model_dump(mode="json")
    own = document[plan.slot]
    kept = own if own["kind"] == choice.kind and plan.sweep.startswith(f"{plan.slot}.") else {}
    document[plan.slot] = {**kept, "kind": choice.kind, **choice.parameters}
    try:
        return session.validate(document)
    except InvalidDocument as failure:
        raise InputError("techniques", f"{choice.label}: {failure}") from None


@dataclass
class Steadying:
    """One sweep under way, which keeps its references.

    Attributes:
        session: draws, bakes and caches. plan: checked.
        tell: told the share done.
    """

    session: Session
    plan: Plan
    tell: Tell | None = None
    _truths: list[Truth] = field(default_factory=list)

    def measure(self, results: Path, folder: Path, machine: Mapping[str, Any]) -> list[dict[str, Any]]:
        """Measure every technique that has no result yet; a strip of each one's worst step goes into `folder`."""
        known = {line["key"]: line for line in read(results)}
        sweep = places(self.session, self.plan)
        found = []
        for number, choice in enumerate(self.plan.choices):
            states = [with_choice(self.session, self.plan, state, choice) for state in sweep]
            key = self._key(states)
            if key not in known:
                line = self._line(choice, states, number, folder)
                known[key] = {"kind": "flicker", "key": key, **line, "machine": dict(machine), "when": int(time.time())}
                append(results, known[key])
            found.append(known[key])
        return found

    def _line(self, choice: Choice, states: Sequence[SceneState], number: int, folder: Path) -> dict[str, Any]:
        """The numbers of one technique, and its strip."""
        truths = self._references(states)
        share = 0.5 / len(self.plan.choices)
        drawn = []
        for turn, state in enumerate(states):
            self._say(0.5 + share * (number + turn / len(states)), f"{choice.label}, frame {turn + 1} of {len(states)}")
            drawn.append(converged(self.session, state, *self.plan.size))
        whole = flicker([one.linear for one in drawn], [one.linear for one in truths])
        once = flicker([one.once for one in drawn if one.once is not None], [one.linear for one in truths])
        self._strip(choice, states, [drawn[whole.worst_step + k].linear for k in (0, 1)], whole, folder)
        plan = self.plan
        return {
            "scene": plan.scene, "preset": plan.preset, "sweep": plan.sweep, "sets": dict(plan.sets),
            "slot": plan.slot, "technique": choice.kind, "parameters": dict(choice.parameters),
            "label": choice.label, "size": list(plan.size), "steps": plan.steps,
            "flicker": whole.value, "worst": whole.worst, "worst_step": whole.worst_step, "each": list(whole.steps),
            "once": {"flicker": once.value, "worst": once.worst, "worst_step": once.worst_step},
            "truth": whole.truth, "reference_standard_error": max(one.standard_error for one in truths),
        }  # fmt: skip

    def _references(self, states: Sequence[SceneState]) -> list[Truth]:
        """References of a sweep: those of its shadows exact, under the picture's own light."""
        if not self._truths:
            for turn, state in enumerate(states):
                self._say(0.5 * turn / len(states), f"reference {turn + 1} of {len(states)}")
                self._truths.append(truth(self.session, state, *self.plan.size, "shadow"))
        return self._truths

    def _strip(
        self, choice: Choice, states: Sequence[SceneState], pair: list[np.ndarray], found: Flicker, folder: Path
    ) -> None:
        state = states[found.worst_step]
        exposure = self.session.exposure_ev(state)
        shown = [displayed(linear, state.view, exposure) for linear in pair]
        folder.mkdir(parents=True, exist_ok=True)
        name = re.sub(r"\W+", "_", f"{self.plan.preset} {self.plan.sweep} {choice.label}")
        (folder / f"{name}.png").write_bytes(save_image("png", strip(shown[0], shown[1], found)))

    def _key(self, states: Sequence[SceneState]) -> str:
        """Changes when a picture or a reference of the sweep may."""
        here = Path(renderer.__path__[0])
        code = code_of(SHADERS, here / self.plan.scene, here / "world", here / "gl")
        bakes = [bake_key(bake) for bake in phenomenon(self.plan.scene).bakes(states[0])]
        truths = [bake_key(truth_bake(state, *self.plan.size, "shadow")) for state in states]
        drawn = [state.model_dump(mode="json") for state in states]
        return key_of("flicker", code, bakes, truths, drawn, list(self.plan.size), PASSES)

    def _say(self, share: float, words: str) -> None:
        if self.tell is not None:
            self.tell(share, words)


def run(session: Session, plans: Sequence[Plan], folder: Path, tell: Tell | None = None) -> list[dict[str, Any]]:
    """Measure several sweeps and write raw results, the table, the chart and the strips of the worst steps.

    Args:
        session: draws, bakes and caches.
        plans: checked, of one scene and size.
        folder: gets `results.jsonl`, `table.md`, `flicker.png`, `flicker.svg` and `worst/`.
        tell: told the share done.
    """
    machine = provenance(session.gl.info.renderer)
    lines: list[dict[str, Any]] = []
    for number, plan in enumerate(plans):

        def inner(share: float, words: str, number: int = number, plan: Plan = plan) -> None:
            if tell is not None:
                tell((number + share) / len(plans), f"{plan.preset}, {plan.sweep}: {words}")

        lines += Steadying(session, plan, inner).measure(folder / "results.jsonl", folder / "worst", machine)
    first = plans[0]
    title = (
        f"{first.scene}: flicker over {first.steps} steps, {first.size[0]} x {first.size[1]} px, {machine['renderer']}"
    )
    write(lines, folder, title)
    return lines
