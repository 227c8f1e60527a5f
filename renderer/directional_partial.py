"""Pictures of the directional textures from the part of their faces that a view asks for, which is baked in seconds.

A layer of a face is what it sees in one direction, and a camera needs some two hundred of the 12,294 that 2,049
directions make. What is drawn of them is the same to the last bit; points that no face sees are kept here, too.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from renderer.comparing import displayed
from renderer.core.baking import bake_key, bake_now
from renderer.core.cache import key_of
from renderer.core.registry import phenomenon
from renderer.core.technique import Arrays, Bake, BakedArrays
from renderer.directional.casting import NONE, Caster, face_frame, face_middles
from renderer.directional.facing import directions_needed, faces_seen
from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.index_code import packed
from renderer.directional_weights import kept
from renderer.gl.targets import Target
from renderer.study.sweep import Drawn
from renderer.truth import POSITIONS
from renderer.view import exposure_of
from renderer.world.sampling import offset

if TYPE_CHECKING:
    from renderer.gl.context import GL
    from renderer.session import Session
    from renderer.world.state import SceneState

KEPT, FACES_KEPT = 40, 24
"""Of what follows from points, and of what faces see from as many sides as a study has, in memory."""

WORTH_KEEPING = 10.0
"""Expected seconds from which on what follows from points is kept on disk, too."""


class Partial:
    """Draws states of the scene.

    Args:
        session: whose OpenGL thread and cache serve.
    """

    def __init__(self, session: Session) -> None:
        self.session = session
        self._phenomenon = phenomenon("directional")
        self.renderer: Any = session.gl.call(self._phenomenon.open)
        self._kept: OrderedDict[Hashable, Arrays] = OrderedDict()
        self._layers: OrderedDict[Hashable, Arrays] = OrderedDict()
        self._caster: tuple[str, Any] = "", None

    def close(self) -> None:
        """Free what the GPU holds."""
        self.session.gl.call(lambda gl: self.renderer.release())

    def drawn(self, state: SceneState, size: int, positions: int = POSITIONS) -> Drawn:
        """The converged picture of a state, without a background: as `renderer.comparing.converged`.

        Args:
            state: a checked state. size: of the picture's sides [px]. positions: within a pixel.
        """
        bare: Any = state.model_copy(update={"view": state.view.model_copy(update={"background": "none"})})
        baked = self.baked(bare)
        linear = self.session.gl.call(self._picture, bare, baked, size, positions)
        return Drawn(linear, displayed(linear, state.view, exposure_of(state, baked)), None)

    def baked(self, state: Any) -> dict[str, BakedArrays]:
        """All that a state needs, its faces as far as the camera asks for them."""
        found: dict[str, BakedArrays] = {}

        def of(bake: Bake) -> BakedArrays:
            if bake.name in found:
                return found[bake.name]
            if bake.name == "visibility":
                mesh, points = (of(source) for source in bake.inputs[:1]), of(_named(self._bakes(state), "cloud"))
                found[bake.name] = self._faces(state, next(mesh), points)
            elif any(source.name == "visibility" for source in _all_inputs(bake)):
                # of every point of the cloud, whatever the view
                inputs = {source.name: of(source) for source in bake.inputs}
                others = [key for name, key in sorted((n, entry.key) for n, entry in inputs.items())
                          if name != "visibility"]  # fmt: skip
                key = key_of("partial", bake.function.__qualname__, bake.version, bake.arguments, others)
                arrays = {name: entry.arrays for name, entry in inputs.items()}
                found[bake.name] = BakedArrays(key, self._keep(key, lambda: self._made(bake, key, arrays)))
            else:
                key = bake_key(bake)
                found[bake.name] = BakedArrays(key, self._keep(key, lambda: bake_now(bake, self.session.cache)))
            return found[bake.name]

        for bake in self._bakes(state):
            of(bake)
        return found

    def _bakes(self, state: Any) -> list[Bake]:
        return self._phenomenon.bakes(state)

    def _faces(self, state: Any, subject: BakedArrays, cloud: BakedArrays) -> BakedArrays:
        camera, faces = state.camera, state.visibility
        key = key_of("partial faces", cloud.key, camera.model_dump(mode="json"), faces.model_dump(mode="json"))

        def make() -> Arrays:
            if cloud.key != self._caster[0]:
                self._caster = cloud.key, Caster(subject.arrays, cloud.arrays)
            return layers_of(camera, faces, self._caster[1], len(cloud.arrays["position"]))

        return BakedArrays(key, self._keep(key, make, True))

    def _made(self, bake: Bake, key: str, inputs: Mapping[str, Arrays]) -> Arrays:
        """A bake's arrays, which are kept on disk where they take long."""
        kept = self.session.cache.get(key) if bake.seconds > WORTH_KEEPING else None
        if kept is not None:
            return kept
        arrays = bake.function(bake.arguments, dict(inputs), lambda share, words: None)
        if bake.seconds > WORTH_KEEPING:
            self.session.cache.put(key, arrays)
        return arrays

    def _keep(self, key: Hashable, make: Callable[[], Arrays], layers: bool = False) -> Arrays:
        store, most = (self._layers, FACES_KEPT) if layers else (self._kept, KEPT)
        return kept(store, key, most, make)

    def _picture(self, gl: GL, state: Any, baked: dict[str, BakedArrays], size: int, positions: int) -> np.ndarray:
        target, total = Target(gl, size, size), np.zeros((size, size, 4))
        try:
            for sample in range(positions):
                prepared = self.renderer.prepare(state, baked, (size, size), offset(sample), sample)
                target.use()
                self.renderer.draw(prepared)
                total += target.read()
            return total / positions
        finally:
            target.release()


def layers_of(camera: Any, faces: Any, caster: Caster, count: int) -> Arrays:
    """What the faces see in the directions that a camera needs, as `renderer.directional.visibility` bakes all of them;
    the others are empty, and every one of the cloud's points, `count` of them, has its own number."""
    box, layout, texels = caster.box, hemisphere_of(int(faces.directions)), faces.texels
    seen = faces_seen(camera, box)
    empty = packed(np.full(texels * texels, NONE, np.uint32))
    data, ends = {}, []
    for face in range(6):
        needed = set(directions_needed(camera, face, box, layout).tolist()) if face in seen else set()
        origins = face_middles(box, face, texels)
        ways = layout.directions() @ face_frame(face)
        layers = [packed(caster.points(origins, -way)) if n in needed else empty for n, way in enumerate(ways)]
        data[f"data_{face}"] = np.frombuffer(b"".join(layers), np.uint8)
        ends.append(np.cumsum([len(layer) for layer in layers]))
    return {
        "used": np.arange(count, dtype=np.int32),
        "number": np.arange(count, dtype=np.uint32),
        "ends": np.stack(ends),
        "texels": np.asarray(texels, np.int32),
        "directions": np.asarray(layout.count, np.int32),
        "box": box,
        **data,
    }


def _all_inputs(bake: Bake) -> list[Bake]:
    return [*bake.inputs, *(deeper for source in bake.inputs for deeper in _all_inputs(source))]


def _named(bakes: list[Bake], name: str) -> Bake:
    return next(bake for bake in bakes if bake.name == name)
