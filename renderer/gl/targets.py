"""What is drawn into: float targets, the running mean of samples, and the displayed picture.

Textures drawn into have the bottom row first, as OpenGL counts; every array read back has the top row first.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Literal

import moderngl
import numpy as np

from renderer.core.errors import UmbrageError
from renderer.gl.context import GL
from renderer.gl.layers import check_drawable
from renderer.gl.program import AnyTexture, bind_textures, set_uniforms
from renderer.gl.source import Source, stage

Curve = Literal["linear", "filmic"]

CURVES: dict[str, int] = {"linear": 0, "filmic": 1}
"""Tone curves by name, to their constants in lib/display.glsl."""

_NUMPY = {"f1": np.uint8, "f2": np.float16, "f4": np.float32, "i4": np.int32, "u4": np.uint32}


class Target:
    """A texture to draw into.

    Args:
        gl: the context's objects.
        width, height: size in pixels.
        dtype: moderngl's name of the component type; "f4" is float32, "f1" bytes that stand for [0, 1].
        components: channels a pixel, 1, 2 or 4 (drawing into 3 is not promised by OpenGL).
        depth: whether it has a depth buffer, for meshes.

    Raises:
        LimitError: larger than the machine can draw.
    """

    def __init__(self, gl: GL, width: int, height: int, dtype: str = "f4", components: int = 4,
                 depth: bool = False) -> None:
        self._gl = gl
        self._dtype = dtype
        self._components = components
        self._depth = depth
        self._make(width, height)

    def _make(self, width: int, height: int) -> None:
        ctx = self._gl.ctx
        check_drawable(self._gl, width, height)
        self.width, self.height = width, height
        self.texture = ctx.texture((width, height), self._components, dtype=self._dtype)
        self.texture.filter = moderngl.NEAREST, moderngl.NEAREST
        self.texture.repeat_x = self.texture.repeat_y = False
        self.depth = ctx.depth_renderbuffer((width, height)) if self._depth else None
        self.framebuffer = ctx.framebuffer([self.texture], self.depth)

    def use(self) -> None:
        """Draw into it from now on, over its whole area."""
        self.framebuffer.use()

    def clear(self) -> None:
        """Set every component to 0, and the depth to the farthest."""
        self.framebuffer.clear(0.0, 0.0, 0.0, 0.0)

    def read(self) -> np.ndarray:
        """Pixels (height, width, components), row 0 at the top."""
        pixels = np.empty((self.height, self.width, self._components), _NUMPY[self._dtype])
        self._gl.finish()
        self.framebuffer.read_into(pixels, components=self._components, alignment=1, dtype=self._dtype)
        return np.ascontiguousarray(pixels[::-1])

    def resize(self, width: int, height: int) -> None:
        """Give it another size; what it held is lost."""
        if (width, height) != (self.width, self.height):
            self.release()
            self._make(width, height)

    def release(self) -> None:
        """Free its objects."""
        self.framebuffer.release()
        self.texture.release()
        if self.depth is not None:
            self.depth.release()


class Accumulator:
    """The running mean of the samples of one picture, summed in float32 in their order.

    The sum is divided where it is shown or read, so the same samples in the same order give the same bits whether the
    picture was looked at between them or not.
    """

    def __init__(self, gl: GL, width: int, height: int) -> None:
        self._gl = gl
        self._sum = Target(gl, width, height)
        self._mean: Target | None = None
        self._mean_of = 0
        self.samples = 0
        """How many samples the sum holds."""

    @property
    def sum_texture(self) -> moderngl.Texture:
        """The sum of the samples, for `ToneMap.draw(..., samples=accumulator.samples)`."""
        return self._sum.texture

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self._sum.width, self._sum.height

    def add(self, texture: moderngl.Texture, sample_index: int) -> None:
        """Add a picture of the same size; sample 0 starts afresh.

        Raises:
            UmbrageError: a sample out of turn, which would make the mean depend on history, or of another size.
        """
        self._check_turn(sample_index)
        if texture.size != self.size:
            raise UmbrageError(f"a sample of {texture.size} pixels cannot be added to {self.size}")
        self._sum.use()
        _copy(self._gl, texture, 1.0, add=sample_index > 0)
        self.samples = sample_index + 1
        self._mean_of = 0

    def draw(self, sample_index: int, draw: Callable[[], None]) -> None:
        """Have `draw` add a sample itself into the bound sum: with one full-screen pass, or with several that add
        (`renderer.gl.parts`); sample 0 starts afresh.

        Raises:
            UmbrageError: a sample out of turn.
        """
        self._check_turn(sample_index)
        self._sum.use()
        if sample_index == 0:
            self._sum.clear()
        with _blending(self._gl, add=sample_index > 0):
            draw()
        self.samples = sample_index + 1

    def _check_turn(self, sample_index: int) -> None:
        if sample_index not in (0, self.samples):
            raise UmbrageError(f"sample {sample_index} came after {self.samples} samples")

    @property
    def mean_texture(self) -> moderngl.Texture:
        """The mean of the samples so far, in a texture of its own."""
        self._check()
        if self._mean is None:
            self._mean = Target(self._gl, *self.size)
            self._mean_of = 0
        if self._mean_of != self.samples:
            self._mean.use()
            _copy(self._gl, self._sum.texture, self.samples)
            self._mean_of = self.samples
        return self._mean.texture

    def read_mean(self) -> np.ndarray:
        """The mean of the samples (height, width, 4) float32, premultiplied linear radiance, row 0 at the top."""
        self._check()
        return np.asarray(self._sum.read() / np.float32(self.samples))

    def resize(self, width: int, height: int) -> None:
        """Give it another size and no samples."""
        self._sum.resize(width, height)
        if self._mean is not None:
            self._mean.release()
            self._mean = None
        self.samples = 0

    def release(self) -> None:
        """Free its objects."""
        self._sum.release()
        if self._mean is not None:
            self._mean.release()
            self._mean = None

    def _check(self) -> None:
        if self.samples == 0:
            raise UmbrageError("no sample was added yet, so there is no mean")


class ToneMap:
    """The displayed picture: exposure, tone curve, background, sRGB, eight bits, dithered."""

    def __init__(self, gl: GL) -> None:
        self._gl = gl
        self._target: Target | None = None

    def draw(self, texture: moderngl.Texture, *, exposure_ev: float = 0.0, curve: Curve = "filmic",
             background: tuple[float, float, float] = (0.0, 0.0, 0.0), samples: int = 1) -> None:
        """Draw the displayed picture of a linear one.

        Args:
            texture: premultiplied linear radiance, or the sum of `samples` of them.
            exposure_ev: EV; radiance is multiplied by 2 to this power.
            curve: "filmic" (Narkowicz 2015) or "linear".
            background: what shows through where alpha is below 1, as linear display light in [0, 1]: after the curve,
                so that white is white at every exposure.
            samples: divisor of the texture.
        """
        if self._target is None:
            self._target = Target(self._gl, texture.width, texture.height, dtype="f1")
        self._target.resize(texture.width, texture.height)
        self._target.use()
        values = {"samples": samples, "exposure_ev": exposure_ev, "curve": CURVES[curve], "background": background}
        with _blending(self._gl, add=False):
            run_fullscreen(self._gl, "stages/display.frag", {"source": texture}, values)

    def read_rgb8(self) -> np.ndarray:
        """The displayed picture (height, width, 3) uint8, row 0 at the top.

        Raises:
            UmbrageError: nothing was drawn yet.
        """
        if self._target is None:
            raise UmbrageError("no picture was drawn yet")
        pixels = np.empty((self._target.height, self._target.width, 3), np.uint8)
        self._gl.finish()
        self._target.framebuffer.read_into(pixels, components=3, alignment=1)
        return pixels  # the stage drew the picture's top row first

    def release(self) -> None:
        """Free its objects."""
        if self._target is not None:
            self._target.release()
            self._target = None


def run_fullscreen(gl: GL, fragment: str | Source, textures: Mapping[str, AnyTexture],
                   values: Mapping[str, Any], writes_depth: bool = False) -> None:
    """Run a fragment stage once per pixel of the bound framebuffer.

    Args:
        fragment: an assembled stage, or the path of one that stands alone.
        textures: samplers by name.
        values: other uniforms by name.
        writes_depth: whether what it gives as depth is kept.
    """
    source = stage(fragment) if isinstance(fragment, str) else fragment
    program = gl.programs.get(stage("stages/fullscreen.vert"), source)
    set_uniforms(program, values)
    bind_textures(program, textures)
    if writes_depth:
        gl.ctx.enable(moderngl.DEPTH_TEST)
        gl.ctx.depth_func = "1"  # always
    gl.programs.draw(program)
    if writes_depth:
        gl.ctx.disable(moderngl.DEPTH_TEST)
        gl.ctx.depth_func = "<"


def run_covered(gl: GL, fragment: Source, textures: Mapping[str, AnyTexture], values: Mapping[str, Any]) -> None:
    """Run a fragment stage once per pixel over which something was drawn into the bound framebuffer's depth.

    What is left out costs nothing even where the CPU draws: blocks of pixels are tested before the stage runs.

    Args:
        fragment, textures, values: as of `run_fullscreen`.
    """
    program = gl.programs.get(stage("stages/at_depth.vert"), fragment)
    set_uniforms(program, {**values, "stage_depth": 1.0})
    bind_textures(program, textures)
    gl.ctx.enable_only(moderngl.DEPTH_TEST)
    gl.ctx.depth_func = ">"
    gl.programs.draw(program)
    gl.ctx.depth_func = "<"
    gl.ctx.enable_only(moderngl.NOTHING)


def _copy(gl: GL, texture: moderngl.Texture, divisor: float, add: bool = False) -> None:
    with _blending(gl, add):
        run_fullscreen(gl, "stages/copy.frag", {"source": texture}, {"divisor": divisor})


@contextmanager
def _blending(gl: GL, add: bool) -> Iterator[None]:
    """Add to the bound target, or replace what it holds, while entered."""
    gl.ctx.disable(moderngl.BLEND | moderngl.DEPTH_TEST)
    if add:
        gl.ctx.enable(moderngl.BLEND)
        gl.ctx.blend_func = moderngl.ONE, moderngl.ONE
        gl.ctx.blend_equation = moderngl.FUNC_ADD  # type: ignore[assignment]
    try:
        yield
    finally:
        gl.ctx.disable(moderngl.BLEND)
        gl.ctx.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
