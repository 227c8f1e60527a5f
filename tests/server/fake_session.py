"""A double of the rendering session: draws gradients, and fails where a test asks it to."""

from __future__ import annotations

import contextlib
import io
import threading
import time
from collections.abc import Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import Any, Literal

import numpy as np
from PIL import Image

from renderer.core.errors import AssetError, Cancelled, InputError, ShaderError
from renderer.core.params import merge, param, set_path, validate
from renderer.world.state import SceneState, samples_of


class FakeState(SceneState):
    """A scene with one parameter of each cost that the server can tell apart."""

    scene: Literal["fake"] = "fake"
    brightness: float = param(0.5, label="Brightness", help="Of the gradient", ge=0, le=1)
    density: int = param(1, label="Density", help="Is baked", cost="bake", ge=1, le=1000)


@dataclass
class FakePicture:
    linear: np.ndarray
    rgb8: np.ndarray
    samples: int
    render_ms: float
    meta: dict[str, Any] = field(default_factory=dict)

    def encode(self, format: str) -> bytes:  # noqa: A002
        buffer = io.BytesIO()
        if format == "npy":
            np.save(buffer, self.linear)
        elif format == "exr":
            buffer.write(b"\x76\x2f\x31\x01")
        else:
            Image.fromarray(self.rgb8).save(buffer, format.upper())
        return buffer.getvalue()


class FakePreparation:
    def __init__(self) -> None:
        self.future: Future[None] = Future()
        self.future.set_running_or_notify_cancel()
        self.cancelled = False

    def cancel(self) -> None:
        self.cancelled = True
        if not self.future.done():
            self.future.set_exception(Cancelled("the work was cancelled"))


class FakeView:
    def __init__(self, session: FakeSession) -> None:
        self.session = session
        self.key: Any = None
        self.samples = 0
        self.closed = False

    def frame(self, state: FakeState, width: int, height: int, more: int = 1) -> Future[Any]:
        return self.session.pool.submit(self._draw, state, width, height, more)

    def _draw(self, state: FakeState, width: int, height: int, more: int) -> Any:
        self.session.drawing.set()
        self.session.gate.wait(10)
        if self.session.draw_seconds:
            time.sleep(self.session.draw_seconds * width * height / 4096)
        if state.brightness == 0.25:
            raise ShaderError("fake/broken.glsl", 7, "syntax error")
        if state.brightness == 0.125:
            raise RuntimeError("a secret of the server")
        if self.key != (state, width, height):
            self.key, self.samples = (state, width, height), 0
        self.samples += more
        self.session.drawn.append((state, width, height, self.samples))
        target = samples_of(state.quality)
        return SimpleNamespace(
            rgb8=paint(state, width, height),
            width=width,
            height=height,
            samples=self.samples,
            target_samples=target,
            converged=self.samples >= target,
            render_ms=1.0,
            technique="gradient",
        )

    def probe(self, state: FakeState, x: float, y: float) -> Future[dict[str, Any]]:
        found = {"elevation": x * 100, "radiance": [float("nan"), 1.0], "y": np.float32(y)}
        return self.session.pool.submit(lambda: found)

    def close(self) -> None:
        self.closed = True


def paint(state: FakeState, width: int, height: int) -> np.ndarray:
    """A gradient that depends on the state, (height, width, 3) uint8."""
    rows = np.linspace(0, 255 * state.brightness, height, dtype=np.float64)[:, None]
    columns = np.linspace(0, 128, width, dtype=np.float64)[None, :]
    channels = [rows + 0 * columns, columns + 0 * rows, 0 * rows + 0 * columns + state.density % 256]
    return np.stack(channels, -1).astype(np.uint8)


class FakeAssets:
    def __init__(self) -> None:
        self.kept: dict[str, Any] = {}

    def list(self) -> list[dict[str, Any]]:
        return [{"hash": digest, "kind": asset.kind, "name": asset.name} for digest, asset in self.kept.items()]

    def get(self, digest: str) -> Any:
        if digest not in self.kept:
            raise AssetError("asset", "there is no uploaded file with this hash, or it has expired")
        return self.kept[digest]


class FakeSession:
    """What `server.facade.RenderSession` asks for, with hooks.

    Attributes:
        gate: drawing waits for it. draw_seconds: time of a 64 x 64 picture [s].
        bake_gate: preparing a density above 1 waits for it. start_gate: so does its very start.
        coarse_density: shown meanwhile.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.gl = SimpleNamespace(info=SimpleNamespace(renderer="fake", vendor="none", version=(3, 3), software=True))
        self.assets = FakeAssets()
        self.pool = ThreadPoolExecutor(1)
        self.coarse_density: float | None = None
        self.gate, self.bake_gate, self.drawing, self.start_gate = (threading.Event() for _ in range(4))
        for gate in (self.gate, self.bake_gate, self.start_gate):
            gate.set()
        self.draw_seconds = 0.0
        self.drawn: list[Any] = []
        self.preparations: list[FakePreparation] = []
        self.views: list[FakeView] = []
        self.baked = {1}
        self.renders = 0
        self.closed = False

    def scenes(self) -> list[dict[str, Any]]:
        presets = [{"name": "noon", "title": "Noon", "help": "High sun"}]
        return [{"name": "fake", "title": "Fake", "help": "A gradient", "presets": presets, "combinations": []}]

    def describe(self, scene: str) -> dict[str, Any]:
        self._known(scene)
        noon = self.state("fake", "noon").model_dump()
        return {
            "name": "fake",
            "title": "Fake",
            "help": "A gradient",
            "schema": FakeState.model_json_schema(),
            "defaults": FakeState().model_dump(mode="json"),
            "slots": [],
            "presets": {"noon": {"title": "Noon", "help": "High sun", "document": noon}},
        }

    def _known(self, scene: Any) -> None:
        if scene != "fake":
            raise InputError("scene", "there is no such scene", "fake")

    def state(
        self,
        scene: str,
        preset: str | None = None,
        sets: Mapping[str, Any] | None = None,
        document: dict[str, Any] | None = None,
        combination: str | None = None,
    ) -> FakeState:
        self._known(scene)
        if combination is not None:
            raise InputError("combination", f"{scene} has no such one", "none")
        found = dict(document) if document is not None else FakeState().model_dump(mode="json")
        if preset is not None:
            if preset != "noon":
                raise InputError("preset", "there is no such preset", "noon")
            found = merge(found, {"brightness": 0.75})
        for path, value in (sets or {}).items():
            found = set_path(found, path, value)
        return validate(FakeState, found)

    def validate(self, document: dict[str, Any]) -> FakeState:
        self._known(document.get("scene"))
        return validate(FakeState, document)

    def prepared(self, state: FakeState) -> bool:
        return state.density in self.baked

    def expected_seconds(self, state: FakeState) -> float:
        return 0.0 if self.prepared(state) else 1.0

    def coarse(self, state: FakeState) -> FakeState | None:
        wanted = self.coarse_density and not self.prepared(state)
        return state.model_copy(update={"density": self.coarse_density}) if wanted else None

    def prepare(self, state: FakeState, on_progress: Any = None) -> FakePreparation:
        preparation = FakePreparation()
        self.preparations.append(preparation)
        self.start_gate.wait(10)
        if self.prepared(state):
            preparation.future.set_result(None)
        else:
            threading.Thread(target=self._bake, args=(state, preparation, on_progress)).start()
        return preparation

    def _bake(self, state: FakeState, preparation: FakePreparation, on_progress: Any) -> None:
        for step in range(1000):
            report = SimpleNamespace(name="density", fraction=step / 1000, words="baking", seconds_left=1.0)
            if on_progress is not None:
                with contextlib.suppress(Cancelled):
                    on_progress(report)
            if preparation.cancelled:
                return
            if self.bake_gate.wait(0.01):
                break
        if state.density == 999:
            preparation.future.set_exception(AssetError("density", "cannot be baked", "1 to 998"))
            return
        self.baked.add(state.density)
        if not preparation.future.done():
            preparation.future.set_result(None)

    def render(self, state: FakeState, width: int, height: int, on_progress: Any = None) -> FakePicture:
        self.renders += 1
        samples = samples_of(state.quality)
        for sample in range(samples):
            if on_progress is not None:
                said = {"name": "picture", "fraction": sample / samples, "words": "drawing", "seconds_left": None}
                on_progress(SimpleNamespace(**said))
            if self.draw_seconds:
                time.sleep(self.draw_seconds * width * height / 4096)
        rgb8 = paint(state, width, height)
        linear = np.concatenate([rgb8 / 255, np.ones((height, width, 1))], -1).astype(np.float32)
        return FakePicture(linear, rgb8, samples, 1.0)

    def outline(self, state: FakeState) -> Any:
        if state.density == 7:
            raise InputError("scene", "has no lines to show", "others")
        ends = np.array([[0, 1], [1, 258]], np.uint32)
        return SimpleNamespace(arrays={"ends": ends}, facts={"lines": 2}, words=("all is well",))

    def compare(self, state: FakeState, width: int, height: int, on_progress: Any = None) -> Any:
        picture = self.render(state, width, height, on_progress)
        return SimpleNamespace(files={"reference.png": picture.encode("png")}, numbers={"relative_rmse": 0.1})

    def sunlight(self, period: Any, state: Any = None, files: Any = None, on_progress: Any = None) -> Any:
        for name in set(period) - {"start"}:
            raise InputError(name, "is no argument", "start")
        while not self.bake_gate.wait(0.01):
            on_progress(SimpleNamespace(name="sun study", fraction=0.5, words="following the sun", seconds_left=1.0))
        hours = np.full((2, 3), files["terrain"].stat().st_size if files else 12.0, np.float32)
        maps, numbers = {"hours": hours, "insolation": hours / 2}, {"hours": {"mean": float(hours.mean())}}
        return SimpleNamespace(arrays=maps, numbers=numbers, geotiff=str.encode, picture=str.encode)

    def add_asset(self, path: Path, filename: str, reading: Mapping[str, Any] | None = None) -> dict[str, Any]:
        data = path.read_bytes()
        if not data.startswith(b"good"):
            raise AssetError("file", "no loader reads this", ".npz .tif")
        kept = self.folder / "kept"
        kept.write_bytes(data)
        self.assets.kept["abc"] = SimpleNamespace(path=kept, kind="terrain", name=filename, expires=1.0)
        return {"asset": "asset:abc", "kind": "terrain", "name": filename, "reading": dict(reading or {}),
                "preview": {}, "expires": 1.0}  # fmt: skip

    def quantities(self) -> list[dict[str, Any]]:
        schema = {"properties": {"factor": {"type": "number"}}}
        files = [{"name": "terrain", "help": "any", "required": False}]
        said = {"name": "length", "title": "Length", "help": "Of a file", "units": {"length": "m"}}
        return [said | {"schema": schema, "files": files}]

    def measure(self, quantity: str, arguments: Mapping[str, Any], files: Mapping[str, Path] | None = None) -> Any:
        for name in set(arguments) - {"factor"}:
            raise InputError(name, "is no argument", "factor")
        factor = arguments.get("factor", 1.0)
        if not isinstance(factor, (int, float)) or not np.isfinite(factor):
            raise InputError("factor", "must be a finite number")
        size = files["terrain"].stat().st_size if files else 2.0
        return SimpleNamespace(arrays={"length": np.array([size * factor, np.nan])}, meta={"units": {"length": "m"}})

    def view(self) -> FakeView:
        self.views.append(FakeView(self))
        return self.views[-1]

    def close(self) -> None:
        self.closed = True
        self.pool.shutdown()
