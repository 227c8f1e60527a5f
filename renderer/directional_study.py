"""The directional textures held to their reference from many sides in many suns, and their silhouettes apart.

Every result is a line that a later call finds again, so that a study that was stopped goes on where it was. Views go
before settings: whenever it stops, every setting has been seen from the same sides, in all suns. What a view's pixels
show and what a sun makes of the points are found once, whatever is combined with them (`renderer.directional_weights`).
"""

from __future__ import annotations

import itertools
import math
import time
from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import renderer
from renderer import truth
from renderer.comparing import displayed, reference
from renderer.core.baking import bake_key
from renderer.core.cache import key_of
from renderer.core.registry import SHADERS, phenomenon
from renderer.directional_partial import Partial
from renderer.directional_settings import BASE, Setting
from renderer.directional_weights import Weighed
from renderer.reference.directional_edges import silhouettes
from renderer.reference.directional_mesh import Subject
from renderer.reference.directional_world import DirectionalWorld
from renderer.study.metrics import flip
from renderer.study.silhouettes import apart, away
from renderer.study.sweep import Drawn, append, compare, provenance, read
from renderer.study_plan import SUNS, light_of
from renderer.truth import code_of, truth_bake
from renderer.view import exposure_of
from renderer.world.camera import rays

if TYPE_CHECKING:
    from renderer.session import Session
    from renderer.world.state import SceneState

Tell = Callable[[float, str], None]
Lines = list[dict[str, Any]]

SCENE = "directional"
VIEWS, SUNS_USED = 24, 8

LOWEST, HIGHEST = -15.0, 75.0
"""Elevations [deg] that the views lie between, evenly by area."""

FIELD_OF_VIEW = 30.0

SIZE = 96
"""Side of the pictures [px]."""

POSITIONS = 144
"""Within a pixel of them. Glints and shadow edges finer than a pixel need that many: at sixteen the reference itself is
17 to 20 % from where it converges on the knot, at 144 less than 3 %."""

BOX = 400
"""Pixels that the box's longest side takes where silhouettes are measured."""

AWAY = 0.01
"""How far a pixel is away from silhouettes at least, before the sky or before the subject itself, in longest sides of
the box: the 4 pixels of 400 within which a silhouette is asked to lie. As far apart are the parts that one parts.
"""


def cameras(box: np.ndarray) -> tuple[dict[str, Any], ...]:
    """Views of a box (2, 3) [m] from all sides, by the golden angle: its ball fills the picture."""
    middle, diagonal = box.mean(axis=0), float(np.linalg.norm(box[1] - box[0]))
    distance = diagonal / 2 / math.sin(math.radians(FIELD_OF_VIEW / 2))
    heights = np.interp((np.arange(VIEWS) + 0.5) / VIEWS, [0, 1], np.sin(np.radians([LOWEST, HIGHEST])))
    golden = 180 * (3 - math.sqrt(5))
    return tuple(
        {
            "kind": "orbit",
            "target": [round(float(v), 6) for v in middle],
            "distance": round(distance, 6),
            "azimuth": round(number * golden % 360, 3),
            "elevation": round(math.degrees(math.asin(height)), 3),
            "field_of_view": FIELD_OF_VIEW,
        }
        for number, height in enumerate(heights)
    )


RIGHT_KEPT = 16
"""References in memory."""

STRIDE = 7
"""From one view to the next in the order in which they are taken: the first few already look from high and low."""


def sides(views: int) -> list[int]:
    """Numbers of so many views, in the order in which they are taken."""
    return [STRIDE * number % VIEWS for number in range(views)]


@dataclass
class Stage:
    """A preset from all sides.

    Attributes:
        session: draws, bakes and caches. preset: of the scene. results: lines that are kept. views, suns: how many.
    """

    session: Session
    preset: str
    results: Path
    views: int = VIEWS
    suns: int = SUNS_USED

    def __post_init__(self) -> None:
        """Find the box, which the views are about."""
        state: Any = self.session.state(SCENE, self.preset)
        subject = next(bake for bake in phenomenon(SCENE).bakes(state) if bake.name == "subject")
        self.box = np.asarray(self.session.compute(subject)["box"], np.float64)
        self.cameras = cameras(self.box)
        self.machine = provenance(self.session.gl.info.renderer)
        here = Path(renderer.__path__[0])
        self.code = code_of(SHADERS / SCENE, SHADERS / "lib", here / SCENE, here / "study")
        self.partial = Partial(self.session)
        self.known = {line["key"]: line for line in read(self.results)}
        self.weighed = Weighed(self.partial, SIZE, POSITIONS)
        self._edges: dict[str, np.ndarray] = {}
        self._right: OrderedDict[str, tuple[Drawn, np.ndarray]] = OrderedDict()

    @property
    def longest(self) -> float:
        """The box's longest side over its diagonal."""
        sides = self.box[1] - self.box[0]
        return float(sides.max() / np.linalg.norm(sides))

    def away(self, state: Any, alpha: np.ndarray) -> np.ndarray:
        """Pixels (H, W) that are away from silhouettes, from the mesh and the reference's opacity."""
        size, camera = len(alpha), state.camera
        if (view := str(camera)) not in self._edges:
            mesh = self.session.compute(next(bake for bake in phenomenon(SCENE).bakes(state) if bake.name == "subject"))
            world = DirectionalWorld(mesh["vertices"], mesh["faces"], mesh["normals"], mesh["colour"],
                                     two_sided=bool(mesh["two_sided"]))  # fmt: skip
            step = AWAY * float((self.box[1] - self.box[0]).max())
            self._edges[view] = silhouettes(Subject(world), lambda place: rays(camera, size, size, place), step)
        return away(np.where(self._edges[view], 0.0, alpha), AWAY * self.longest * size)

    def state(self, setting: Setting, view: int, sun: str) -> SceneState:
        """The document of a case."""
        sets = {**setting.sets(), **light_of(sun), "camera": self.cameras[view]}
        exposure = sets.pop("exposure")
        return self.session.state(SCENE, self.preset, {**sets, "view.exposure": exposure})

    def measured(
        self, part: str, setting: Setting, view: int, sun: str, size: int, measure: Measure, positions: int = POSITIONS
    ) -> dict[str, Any]:
        """The line of a case, measured where there is none."""
        state = self.state(setting, view, sun)
        bakes = [bake_key(bake) for bake in phenomenon(SCENE).bakes(state)]
        answer = bake_key(truth_bake(state, size, size, positions=positions))
        key = key_of(part, size, self.code, bakes, answer, state.model_dump(mode="json"))
        if key not in self.known:
            self.known[key] = {
                "key": key, "part": part, "preset": self.preset, "view": view, "sun": sun, **asdict(setting),
                **measure(self.partial, state, size), "machine": self.machine, "when": int(time.time()),
            }  # fmt: skip
            append(self.results, self.known[key])
        return self.known[key]

    def swept(self, part: str, settings: Sequence[Setting], tell: Tell) -> Lines:
        """Lines of settings over all views and suns, those that share a code of shadows behind each other."""
        found: Lines = []
        ordered = sorted(settings, key=lambda each: str(_shading(each)))
        suns = tuple(SUNS)[: self.suns]
        total = self.views * len(ordered) * len(suns)
        for view in sides(self.views):
            for code, group in itertools.groupby(ordered, key=_shading):
                some = list(group)
                for sun in suns:
                    tell(len(found) / total, f"{code.code}, {code.shadow_directions} directions: view {view}, {sun}")
                    found += [self.measured(part, setting, view, sun, SIZE, self._picture) for setting in some]
        return found

    def right(self, state: SceneState) -> tuple[Drawn, np.ndarray]:
        """The reference of a state, and which of its pixels are away from silhouettes."""
        bake = truth.truth_bake(state, SIZE, SIZE, positions=POSITIONS)
        if (key := bake_key(bake)) not in self._right:
            found = truth.truth_of(self.session.compute(bake))
            shown = reference(found, state.view, exposure_of(state, self.partial.baked(state)))
            self._right[key] = shown, self.away(state, shown.linear[..., 3])
            while len(self._right) > RIGHT_KEPT:
                self._right.popitem(last=False)
        return self._right[key]

    def picture(self, state: SceneState) -> Drawn:
        """The converged picture of a state, without a background."""
        linear = self.weighed.linear(state)
        return Drawn(linear, displayed(linear, state.view, exposure_of(state, self.partial.baked(state))))

    def _picture(self, partial: Partial, state: SceneState, size: int) -> dict[str, Any]:
        picture, (right, mask) = self.picture(state), self.right(state)
        whole = compare(picture, right)
        return {
            **{name: whole[name] for name in ("relative_rmse", "flip_mean", "flip_p95", "reference_standard_error")},
            **within(picture.linear, right.linear, mask),
        }

    def outlines(self, settings: Sequence[Setting], tell: Tell) -> Lines:
        """Lines of how far silhouettes lie from the true ones, the box's longest side `BOX` pixels long."""
        found: Lines = []
        size = math.ceil(BOX / self.longest)
        for number, setting in enumerate(settings):
            for view in range(self.views):
                tell((number * self.views + view) / len(settings) / self.views, f"outline {view + 1} of {setting}")
                sun, side = next(iter(SUNS)), sides(self.views)[view]
                found.append(self.measured("silhouette", setting, side, sun, size, _outline, truth.POSITIONS))
        return found


Measure = Callable[[Partial, "SceneState", int], Mapping[str, Any]]


def drawn(partial: Partial, state: SceneState, size: int, positions: int) -> tuple[Drawn, Drawn]:
    """A state's converged picture, and its reference, at so many positions within a pixel."""
    found = truth.truth_of(partial.session.compute(truth.truth_bake(state, size, size, positions=positions)))
    picture = partial.drawn(state, size, positions)
    return picture, reference(found, state.view, exposure_of(state, partial.baked(state)))


def _shading(setting: Setting) -> Setting:
    """What of a setting lights points, the rest left out."""
    return replace(setting, texels=0, directions=0, selection="")


def within(picture: np.ndarray, right: np.ndarray, mask: np.ndarray) -> dict[str, float | None]:
    """Relative RMSE over some pixels, `away`, without the worst 2 % of them, `most`, and what `share` of the picture
    they are; None where none has light. A glint that moves by a pixel outweighs all else in a view against the light.
    """
    off = ((picture[..., :3] - right[..., :3]) ** 2).mean(axis=-1)
    level = float(right[mask][:, :3].mean()) if mask.any() else 0.0
    if level <= 0:
        return {"away": None, "most": None, "share": 0.0}
    least = off[mask][off[mask] <= np.percentile(off[mask], 98)]
    whole, most = (float(np.sqrt(some.mean())) / level for some in (off[mask], least))
    return {"away": whole, "most": most, "share": float(mask.mean())}


def _outline(partial: Partial, state: SceneState, size: int) -> dict[str, Any]:
    picture, right = drawn(partial, state, size, truth.POSITIONS)
    return asdict(apart(picture.linear[..., 3], right.linear[..., 3]))


def finer(stage: Stage, tell: Tell) -> Lines:
    """129 against 513 directions of a point's hemisphere: how far the two pictures are apart, and each from the truth.

    Returns:
        Lines with FLIP between the two (`between_mean`, `between_p95`), their relative RMSE `between`, and `coarse` and
        `fine`, either's relative RMSE to the reference away from silhouettes.
    """
    found: Lines = []
    fine, coarse = BASE, replace(BASE, shadow_directions=129)
    suns = tuple(SUNS)[: stage.suns]

    def measure(partial: Partial, state: SceneState, size: int) -> dict[str, Any]:
        other: Any = partial.session.state(SCENE, document={**state.model_dump(mode="json"), **_shadows(coarse)})
        few, many = stage.picture(other), stage.picture(state)
        right, mask = stage.right(state)
        seen = flip(few.rgb8, many.rgb8)
        level = float(right.linear[..., :3].mean())
        apart_ = float(np.sqrt(np.mean((few.linear[..., :3] - many.linear[..., :3]) ** 2))) / level
        return {
            "between": apart_, "between_mean": seen.mean, "between_p95": seen.p95,
            "coarse": within(few.linear, right.linear, mask)["away"],
            "fine": within(many.linear, right.linear, mask)["away"],
        }  # fmt: skip

    for view, sun in itertools.product(sides(stage.views), suns):
        tell(len(found) / len(suns) / stage.views, f"129 against 513, view {view}, {sun}")
        found.append(stage.measured("finer", fine, view, sun, SIZE, measure))
    return found


def _shadows(setting: Setting) -> dict[str, Any]:
    return {"hemispheres": {"directions": setting.shadow_directions}}
