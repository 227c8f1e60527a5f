"""The facade that the server, the command line and notebooks see: states in, pictures out."""

from __future__ import annotations

import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Mapping
from concurrent.futures import Executor
from pathlib import Path
from typing import TYPE_CHECKING, Any

from renderer.core.baking import bake_key
from renderer.core.cache import AssetStore, Cache
from renderer.core.channel import Progress
from renderer.core.errors import InputError, UmbrageError
from renderer.core.params import merge, set_path, validate
from renderer.core.registry import phenomena, phenomenon
from renderer.core.technique import Arrays, Bake, BakedArrays, Outline
from renderer.core.work import Workers
from renderer.describing import described, listed
from renderer.gl.thread import GLThread
from renderer.picture import Frame, Picture
from renderer.preparation import Preparation, coarse_of, following
from renderer.view import Painter, Place, View, exposure_of, paint
from renderer.world.sampling import offset
from renderer.world.state import SceneState, migrate, samples_of

if TYPE_CHECKING:
    from renderer.comparing import Comparison
    from renderer.study.measure import Measurement
    from renderer.sun_study import SunStudy
    from renderer.truth import Judge

Report = Callable[[Progress], None]
KEPT_IN_MEMORY = 24  # baked results; what one state needs is well below

__all__ = ["Frame", "Picture", "Preparation", "Session", "View"]


class Session:
    """One per process: the GL thread, the cache, the bakes and the views.

    Args:
        cache: of precomputations; the user's own by default.
        executor: runs the bakes; local worker processes by default, any standard `Executor` otherwise.
        assets: uploaded files.
    """

    def __init__(
        self, cache: Cache | None = None, executor: Executor | None = None, assets: AssetStore | None = None
    ) -> None:
        self.cache = cache or Cache()
        self.assets = assets or AssetStore()
        self.gl = GLThread()
        self._workers = Workers(executor)
        self._long = Workers(executor)  # of its own, or every view's bake would wait for whoever wants a reference
        self._painter = Painter(self.gl)
        self._loaded: OrderedDict[str, BakedArrays] = OrderedDict()
        self._lock = threading.Lock()
        self._views = 0

    def scenes(self) -> list[dict[str, Any]]:
        """Name, title, help and presets of every scene."""
        return [listed(found) for found in phenomena().values()]

    def describe(self, scene: str) -> dict[str, Any]:
        """Schema, defaults, presets and slots of a scene, for the page and the command line.

        Raises:
            InputError: there is no such scene.
        """
        found = phenomenon(scene)
        documents = {name: self.state(scene, name).model_dump(mode="json") for name in found.presets}
        return described(found, documents, self.gl.info.version)

    def state(
        self,
        scene: str,
        preset: str | None = None,
        sets: Mapping[str, Any] | None = None,
        document: dict[str, Any] | None = None,
        combination: str | None = None,
    ) -> SceneState:
        """A checked state: the scene's defaults, then a preset, a document, a combination and single values over them.

        Raises:
            InputError, InvalidDocument: naming the field.
        """
        found = phenomenon(scene)
        made: dict[str, Any] = found.state().model_dump(mode="json")
        if preset is not None:
            if preset not in found.presets:
                raise InputError("preset", f"{scene} has no such preset", ", ".join(found.presets))
            made = merge(made, found.presets[preset].patch)
        if document is not None:
            made = merge(made, migrate(document))
        if combination is not None:
            if combination not in found.combinations:
                raise InputError("combination", f"{scene} has no such one", ", ".join(found.combinations) or "none")
            made = merge(made, found.combinations[combination].patch)
        for path, value in (sets or {}).items():
            made = set_path(made, path, value)
        return validate(found.state, made)  # type: ignore[return-value]

    def validate(self, document: Any) -> SceneState:
        """Check a whole document; fields it leaves out take their defaults.

        Raises:
            InputError, InvalidDocument: naming the field.
        """
        scene = (current := migrate(document)).get("scene")
        if not isinstance(scene, str):
            raise InputError("scene", "a state names its scene", ", ".join(phenomena()))
        return validate(phenomenon(scene).state, current)  # type: ignore[return-value]

    def prepared(self, state: SceneState) -> bool:
        """Whether the state can be drawn at once: all it needs is in memory."""
        with self._lock:
            return all(bake_key(bake) in self._loaded for bake in self._bakes(state))

    def expected_seconds(self, state: SceneState) -> float:
        """What baking the state will take on two cores; 0 where the cache has it all."""
        return sum(bake.seconds for bake in self._bakes(state) if bake_key(bake) not in self.cache)

    coarse = coarse_of

    def prepare(self, state: SceneState, on_progress: Report | None = None) -> Preparation:
        """Bake what the state needs, or take it from the cache; nobody waits on this thread."""
        bakes = self._bakes(state)
        task = self._workers.run_all(bakes, self.cache, on_progress)
        return following(task, lambda arrays: self._keep(bakes, arrays))

    def render(self, state: SceneState, width: int, height: int, on_progress: Report | None = None) -> Picture:
        """Bake what is missing, telling of it, and draw the picture that `state.quality` asks for; blocks.

        Raises:
            LimitError: larger than this machine can draw.
        """
        return self.draw(state, width, height, samples_of(state.quality), on_progress=on_progress)

    def draw(
        self,
        state: SceneState,
        width: int,
        height: int,
        samples: int,
        place: Place = offset,
        on_progress: Report | None = None,
    ) -> Picture:
        """As `render`, with so many samples, each at its `place` in the pixel; blocks."""
        if not self.prepared(state):
            self.prepare(state, on_progress).future.result()
        started = time.monotonic()

        def tell(done: int) -> None:
            if on_progress is not None and done:
                left = (time.monotonic() - started) * (samples - done) / done
                on_progress(Progress("picture", done / samples, f"sample {done} of {samples}", left))

        return paint(self.gl, self._painter, state, self._arrays(state), (width, height), samples, place, tell)

    def exposure_ev(self, state: SceneState) -> float:
        """Stops by which a state's radiance [W m-2 sr-1] is brightened for display; blocks while it is baked."""
        if not self.prepared(state):
            self.prepare(state).future.result()
        return exposure_of(state, self._arrays(state))

    def outline(self, state: SceneState) -> Outline:
        """What a state's scene is built of, as lines: see `renderer.outlining`; blocks while it is baked."""
        from renderer import outlining

        return outlining.outline_of(self, state, self._arrays)

    def compute(self, bake: Bake, on_progress: Report | None = None) -> Arrays:
        """The arrays of one bake that may take minutes, from the cache or from a worker process; blocks.

        What views wait for is computed elsewhere meanwhile.

        Raises:
            Cancelled: by `on_progress`.
        """
        return self._long.run(bake, self.cache, on_progress).future.result()

    def compare(
        self,
        state: SceneState,
        width: int,
        height: int,
        on_progress: Report | None = None,
        judge: Judge = "combination",
    ) -> Comparison:
        """Compare the converged picture of a state with its reference: see `renderer.comparing`; blocks."""
        from renderer import comparing

        return comparing.compare(self, state, width, height, on_progress, judge)

    def sunlight(
        self,
        period: Mapping[str, Any],
        state: SceneState | None = None,
        files: Mapping[str, Path] | None = None,
        on_progress: Report | None = None,
    ) -> SunStudy:
        """Hours of direct sun and irradiation over a land, from the cache as far as it has them; blocks.

        Args:
            period: a document of `renderer.world.sun_course.SunlightPeriod`: days, place, receiver.
            state: the land that it draws; without one, `files`: `terrain`, and heights of the `canopy` over it.

        Raises:
            InvalidDocument, InputError, LimitError: naming the argument.
        """
        from renderer import sun_studying

        land = sun_studying.land_of(self, state, files or {})
        return sun_studying.study(self._long, self.cache, land, period, on_progress)

    def view(self) -> View:
        """A canvas of its own: its mean of samples, and its mailbox on the GL thread."""
        with self._lock:
            self._views += 1
            name = f"view-{self._views}"
        return View(name, self.gl, self._painter, self._arrays)

    def add_asset(self, path: Path, filename: str, reading: Mapping[str, Any] | None = None) -> dict[str, Any]:
        """Check an uploaded file in a process of its own and keep it: see `renderer.world.upload.admit`."""
        return self.admit(self.assets, path, filename, reading)

    @staticmethod
    def admit(assets: AssetStore, path: Path, name: str, reading: Mapping[str, Any] | None = None) -> dict[str, Any]:
        """As `add_asset`, into any store; needs no GL."""
        from renderer.world.upload import admit

        return admit(assets, path, name, reading)

    @staticmethod
    def quantities() -> list[dict[str, Any]]:
        """What can be measured: name, title, help, schema of the arguments, files and units; needs no GL."""
        from renderer.study import measure

        return [measure.describe(name) for name in measure.names()]

    @staticmethod
    def measure(quantity: str, arguments: Mapping[str, Any], files: Mapping[str, Path] | None = None) -> Measurement:
        """Measure a physical quantity; needs no GL.

        Args:
            quantity: one of `quantities()`.
            arguments: a document of its declared arguments.
            files: paths of the files that it reads, by name.

        Raises:
            InputError, InvalidDocument: naming the argument.
        """
        from renderer.study import measure

        return measure.measure(quantity, arguments, files)

    def close(self) -> None:
        """End the bakes, the views and the GL thread."""
        self._long.close()
        self._workers.close()
        self.gl.close()

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _bakes(self, state: SceneState) -> list[Bake]:
        return phenomenon(state.scene).bakes(state)

    def _keep(self, bakes: list[Bake], arrays: Mapping[str, Any]) -> None:
        with self._lock:
            for bake in bakes:
                key = bake_key(bake)
                self._loaded[key] = BakedArrays(key, arrays[bake.name])
                self._loaded.move_to_end(key)
            while len(self._loaded) > max(KEPT_IN_MEMORY, len(bakes)):
                self._loaded.popitem(last=False)

    def _arrays(self, state: SceneState) -> dict[str, BakedArrays]:
        """What the state needs, from memory, or from the cache where other states have pushed it out."""
        found = {}
        for bake in self._bakes(state):
            key = bake_key(bake)
            with self._lock:
                held = self._loaded.get(key)
                if held is not None:
                    self._loaded.move_to_end(key)  # what is drawn stays, whatever others prepare
            if held is None:
                arrays = self.cache.get(key)
                if arrays is None:
                    raise UmbrageError(f"{bake.name} is not baked for this state; prepare it first")
                self._keep([bake], {bake.name: arrays})
                held = BakedArrays(key, arrays)
            found[bake.name] = held
        return found
