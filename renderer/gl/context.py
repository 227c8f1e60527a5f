"""The OpenGL context as jobs see it: what the machine offers, and every object made with it, counted."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

import moderngl
import numpy as np

from renderer.core.errors import GLThreadError, GLUnavailable, UmbrageError
from renderer.gl import textures
from renderer.gl.program import ProgramCache
from renderer.gl.textures import Filter, Wrap
from renderer.gl.timing import GpuTimer
from renderer.gl.waiting import finisher

OLDEST = (3, 3)
"""Lowest OpenGL version on which anything runs."""

_WANTED = (460, 450, 440, 430, 420, 410, 400, 330)
_CREATORS = ("buffer", "texture", "texture3d", "texture_array", "texture_cube", "depth_texture", "depth_texture_cube",
             "renderbuffer", "depth_renderbuffer", "framebuffer", "simple_framebuffer", "empty_framebuffer", "program",
             "compute_shader", "vertex_array", "simple_vertex_array", "sampler", "scope")
_SOFTWARE = ("llvmpipe", "softpipe", "swrast", "swiftshader", "software")
_ADVICE = "install Mesa's EGL: apt-get install libegl1 libgl1 libgl1-mesa-dri"


class Releasable(Protocol):
    """Anything that holds GL objects."""

    def release(self) -> None:
        """Free them."""


Object = TypeVar("Object")


class GLError(UmbrageError):
    """OpenGL refused a command of a job."""


class GLLeak(UmbrageError):
    """GL objects were still alive when their context closed."""


@dataclass(frozen=True)
class GLInfo:
    """What draws.

    Attributes:
        renderer, vendor: the driver's names.
        version: OpenGL version, as (4, 5).
        software: whether the CPU does the drawing.
    """

    renderer: str
    vendor: str
    version: tuple[int, int]
    software: bool


def create_context() -> moderngl.Context:
    """A context without a window, through EGL, of the highest version that the driver gives.

    Raises:
        GLUnavailable: in words, with the package to install where EGL is missing.
    """
    failure: Exception | None = None
    for version in _WANTED:
        try:
            # moderngl's own stub takes each setting for a dictionary of settings.
            return moderngl.create_context(version, standalone=True, backend="egl")  # type: ignore[arg-type]
        except Exception as error:  # glcontext raises bare exceptions
            failure = error
            if "not loaded" in str(error):
                raise GLUnavailable(f"OpenGL is not installed on this machine ({error}); {_ADVICE}") from None
    raise GLUnavailable(f"no OpenGL {OLDEST[0]}.{OLDEST[1]} context can be made on this machine ({failure}); "
                        f"update the graphics driver, or {_ADVICE}")


def describe(ctx: moderngl.Context) -> GLInfo:
    """What a context draws with."""
    renderer = str(ctx.info["GL_RENDERER"])
    return GLInfo(renderer, str(ctx.info["GL_VENDOR"]), (ctx.version_code // 100, ctx.version_code // 10 % 10),
                  any(name in renderer.lower() for name in _SOFTWARE))


class GL:
    """What a job on the GL thread receives.

    Every object made through `ctx` is counted until its `release()`, whoever made it. An owner that lives as long
    as the context registers itself with `at_close`.
    """

    def __init__(self, ctx: moderngl.Context) -> None:
        self._thread = threading.get_ident()
        self._ctx = ctx
        self._live: dict[int, Any] = {}
        self._owners: list[Releasable] = []
        self.left = 0
        self._nowhere = ctx.detect_framebuffer(0)
        for name in _CREATORS:
            if hasattr(ctx, name):
                setattr(ctx, name, self._counting(getattr(ctx, name)))
        self.info = describe(ctx)
        self.finish = finisher()
        """Wait until everything drawn is done, while other threads of Python go on."""
        self.programs = ProgramCache(ctx, self.finish if self.info.software else None)
        self._timer: GpuTimer | None = None
        self.at_close(self.programs)

    @property
    def ctx(self) -> moderngl.Context:
        """The context.

        Raises:
            GLThreadError: the caller is not on the thread that owns it.
        """
        if threading.get_ident() != self._thread:
            raise GLThreadError(f"thread {threading.current_thread().name!r} touched the OpenGL context, which only "
                                "its own thread may use: submit a job to it")
        return self._ctx

    def timer(self) -> GpuTimer:
        """The timer of GPU work; one for all, since measurements do not nest."""
        if self._timer is None:
            self._timer = GpuTimer(self.ctx, self.info.software)
        return self._timer

    def texture2d(self, data: np.ndarray, filter: Filter = "linear", wrap: Wrap = "clamp",  # noqa: A002
                  mips: Sequence[np.ndarray] = ()) -> moderngl.Texture:
        """A 2D texture from an array: see `textures.texture2d`."""
        return textures.texture2d(self.ctx, data, filter, wrap, mips)

    def texture3d(self, data: np.ndarray, filter: Filter = "linear",  # noqa: A002
                  wrap: tuple[Wrap, Wrap, Wrap] = ("clamp", "clamp", "clamp"),
                  mips: Sequence[np.ndarray] = ()) -> moderngl.Texture3D:
        """A 3D texture from an array: see `textures.texture3d`."""
        return textures.texture3d(self.ctx, data, filter, wrap, mips)

    def texture_array(self, data: np.ndarray, filter: Filter = "linear",  # noqa: A002
                      wrap: Wrap = "clamp", mips: Sequence[np.ndarray] = ()) -> moderngl.TextureArray:
        """An array of 2D textures: see `textures.texture_array`."""
        return textures.texture_array(self.ctx, data, filter, wrap, mips)

    def own(self, made: Object) -> Object:
        """Count an object that has `release()` and was not made through `ctx`; returns it."""
        self._live[id(made)] = made
        return made

    def at_close(self, owner: Releasable) -> None:
        """Have `owner.release()` called before the context closes, last registered first."""
        self._owners.append(owner)

    def forget(self, owner: Releasable) -> None:
        """Take back `at_close`, for an owner that was released before."""
        self._owners = [known for known in self._owners if known is not owner]

    def live_objects(self) -> Counter[str]:
        """How many objects of each type are not released."""
        self._live = {key: made for key, made in self._live.items() if _alive(made)}
        return Counter(type(made).__name__ for made in self._live.values())

    def require(self, version: tuple[int, int], what: str) -> None:
        """Check that the machine has an OpenGL version.

        Raises:
            GLUnavailable: it has less than `what` requires.
        """
        if self.info.version < version:
            has = self.info.version
            raise GLUnavailable(f"{what} requires OpenGL {version[0]}.{version[1]}; "
                                f"this machine has {has[0]}.{has[1]} ({self.info.renderer})")

    def reset(self) -> None:
        """Put the pipeline's switches where every job finds them: all off, ordinary blending, nothing half bound."""
        self._nowhere.viewport = 0, 0, 1, 1  # a job may have set it while nothing else was bound
        self._nowhere.use()
        self._ctx.enable_only(moderngl.NOTHING)
        self._ctx.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
        self._ctx.blend_equation = moderngl.FUNC_ADD  # type: ignore[assignment]
        self._ctx.depth_func = "<"
        self._ctx.front_face = "ccw"
        self._ctx.cull_face = "back"
        self._ctx.clear_errors()

    def check(self) -> None:
        """Tell whether OpenGL refused a command since the last `reset`.

        Raises:
            GLError: it did.
        """
        error = self._ctx.error
        if error != "GL_NO_ERROR":
            raise GLError(f"OpenGL refused a command of this job: {error}")

    def close(self) -> None:
        """Release every owner, then the context.

        Raises:
            GLLeak: objects that no owner released; they are freed with the context all the same.
        """
        failures = []
        for owner in reversed(self._owners):
            try:
                owner.release()
            except Exception as failure:
                failures.append(f"{type(owner).__name__}.release: {failure}")
        self._owners = []
        left = self.live_objects()
        self.left = left.total()
        for made in self._live.values():
            made.release()
        self._live = {}
        self._ctx.release()
        if left:
            failures.append("not released: " + ", ".join(f"{count} {name}" for name, count in sorted(left.items())))
        if failures:
            raise GLLeak("the OpenGL context closed uncleanly: " + "; ".join(failures))

    def _counting(self, create: Callable[..., Any]) -> Callable[..., Any]:
        def counted(*args: Any, **kwargs: Any) -> Any:
            made = self.own(create(*args, **kwargs))
            if isinstance(made, moderngl.Framebuffer):
                self._unbind_before_release(made)
            return made
        return counted

    def _unbind_before_release(self, framebuffer: moderngl.Framebuffer) -> None:
        """moderngl binds the last used framebuffer again after making one, which fails once that one was released."""
        release = framebuffer.release

        def unbound() -> None:
            if self._ctx.fbo is framebuffer:
                self._nowhere.use()
            release()
        framebuffer.release = unbound  # type: ignore[method-assign]


def _alive(made: Any) -> bool:
    return not isinstance(getattr(made, "mglo", None), moderngl.InvalidObject)
