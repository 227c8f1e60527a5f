"""Waiting for OpenGL without stopping Python.

moderngl keeps the interpreter's lock while a command blocks; a call through ctypes gives it up. Where the CPU draws, a
read of a picture blocks for the whole drawing, and no other thread could encode, send or receive meanwhile.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass

LIBRARY = "libEGL.so.1"


@dataclass(frozen=True)
class Waiting:
    """Commands for the context that is current on the calling thread, with the interpreter's lock given up.

    Attributes:
        flush: OpenGL's `glFlush`: what was commanded is begun.
        finish: OpenGL's `glFinish`: what was commanded is done.
    """

    flush: Callable[[], None]
    finish: Callable[[], None]


def waiting() -> Waiting:
    """Both commands; where the library does not answer, functions that do nothing: what follows waits by itself."""
    return Waiting(_command("glFlush"), _command("glFinish"))


def _command(name: str) -> Callable[[], None]:
    try:
        library = ctypes.CDLL(LIBRARY)
        library.eglGetProcAddress.restype = ctypes.c_void_p
        address = library.eglGetProcAddress(name.encode())
    except (OSError, AttributeError):
        return _nothing
    return ctypes.CFUNCTYPE(None)(address) if address else _nothing


def _nothing() -> None:
    """Waits for nothing."""
