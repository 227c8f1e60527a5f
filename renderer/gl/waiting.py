"""Waiting for OpenGL without stopping Python.

moderngl keeps the interpreter's lock while a command blocks; a call through ctypes gives it up. Where the CPU draws, a
read of a picture blocks for the whole drawing, and no other thread could encode, send or receive meanwhile.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable

LIBRARY = "libEGL.so.1"


def finisher() -> Callable[[], None]:
    """OpenGL's `glFinish` for the context that is current on the calling thread, with the interpreter's lock given up.

    Where the library does not answer, a function that does nothing: what follows then waits by itself.
    """
    try:
        library = ctypes.CDLL(LIBRARY)
        library.eglGetProcAddress.restype = ctypes.c_void_p
        address = library.eglGetProcAddress(b"glFinish")
    except (OSError, AttributeError):
        return _nothing
    return ctypes.CFUNCTYPE(None)(address) if address else _nothing


def _nothing() -> None:
    """Waits for nothing."""
