"""Arrays out of a stranger's .npz: nothing is allocated before its header was believed, and nothing is unpickled."""

from __future__ import annotations

import os
import struct
import zipfile
import zlib
from collections.abc import Collection
from pathlib import Path
from typing import IO

import numpy as np
from numpy.lib import format as npy

from renderer.core.errors import AssetError, LimitError

MAX_MEMBERS = 64
"""An archive of ours holds a handful of arrays; more is no .npz of this kind."""

MAX_DIRECTORY = 16_384
"""Bytes of an archive's directory: 64 members of 46 bytes and a name each take some 5,000."""

MAX_HEADER = 4096
"""Characters of an .npy header: a plain shape and type need about a hundred."""


def npz_names(path: Path) -> list[str]:
    """Names of the arrays in the archive at `path`; raises as `archive_names`."""
    return [name.removesuffix(".npy") for name in archive_names(path) if name.endswith(".npy")]


def archive_names(path: Path) -> list[str]:
    """Names of the members of the archive at `path`.

    Raises:
        AssetError: not a zip archive, or one with more members than an archive of ours can have.
    """
    try:
        _check_directory(path)
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
    except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError) as failure:
        raise AssetError("file", "is no complete .npz archive") from failure
    if len(names) > MAX_MEMBERS:
        raise AssetError("file", f"holds {len(names)} members", f"at most {MAX_MEMBERS}")
    return names


def _check_directory(path: Path) -> None:
    """Refuse an archive by the size of its directory, which zipfile would hold whole before any of it can be counted.

    The end record is asked for where NumPy leaves it: in the last 22 bytes, without comment and without the 64-bit
    locator that could contradict it (PKWARE APPNOTE 6.3.10, sections 4.3.15 and 4.3.16).
    """
    with path.open("rb") as stream:
        length = stream.seek(0, os.SEEK_END)
        stream.seek(max(length - 42, 0))
        tail = stream.read()
    if tail[-22:-18] != b"PK\5\6" or tail[-2:] != b"\0\0" or tail[-42:-38] == b"PK\6\7":
        raise AssetError("file", "is no complete .npz archive")
    directory = struct.unpack("<I", tail[-10:-6])[0]
    if directory > MAX_DIRECTORY:
        raise AssetError("file", f"has an archive directory of {directory:,} bytes", f"at most {MAX_DIRECTORY:,}")


def read_npz(path: Path, wanted: Collection[str], max_bytes: int) -> dict[str, np.ndarray]:
    """The arrays of `wanted` that the archive at `path` holds.

    Args:
        path: the .npz file.
        wanted: array names; a name that the file lacks is left out, other members are never opened.
        max_bytes: most bytes of one array, as its header claims and as it decompresses.

    Raises:
        AssetError: naming the array (or `file`) that is damaged, truncated or not plain numbers or text.
        LimitError: naming the array whose header claims more than `max_bytes`.
    """
    found = [name for name in npz_names(path) if name in wanted]
    result: dict[str, np.ndarray] = {}
    with zipfile.ZipFile(path) as archive:
        for name in found:
            try:
                with archive.open(f"{name}.npy") as stream:
                    result[name] = _read_array(stream, name, max_bytes)
            except (
                zipfile.BadZipFile,
                zlib.error,
                EOFError,
                OSError,
                RuntimeError,
                NotImplementedError,
                KeyError,
            ) as failure:
                raise AssetError(name, "is damaged or cut short in the file") from failure
    return result


def read_npy(path: Path, name: str, max_bytes: int) -> np.ndarray:
    """The array in the .npy file at `path`; `name` and the errors as in `read_npz`."""
    with path.open("rb") as stream:
        return _read_array(stream, name, max_bytes)


def _read_array(stream: IO[bytes], name: str, max_bytes: int) -> np.ndarray:
    """One array of the archive: its header first, then exactly the bytes that the header promises."""
    try:
        version = npy.read_magic(stream)
        readers = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}
        if version not in readers:
            raise AssetError(name, f"is written in .npy version {version[0]}.{version[1]}", "version 1.0 or 2.0")
        shape, fortran, dtype = readers[version](stream, max_header_size=MAX_HEADER)
    except (ValueError, SyntaxError, TypeError, RecursionError, MemoryError) as failure:
        raise AssetError(name, "has a damaged array header") from failure
    if dtype.hasobject or dtype.kind not in "biufU":
        raise AssetError(name, "holds Python objects or records", "plain numbers or text")
    count = 1
    for length in shape:
        count *= int(length)
    claimed = count * dtype.itemsize
    if min(shape, default=1) < 0 or claimed > max_bytes:
        raise LimitError(name, f"claims {claimed:,} bytes for shape {tuple(shape)}", f"at most {max_bytes:,} bytes")
    data = stream.read(claimed + 1)
    if len(data) != claimed:
        raise AssetError(
            name,
            f"has {min(len(data), claimed):,} bytes or more where its header claims {claimed:,}"
            if len(data) > claimed
            else f"is cut short: {len(data):,} of {claimed:,} bytes",
        )
    array = np.frombuffer(data, dtype=dtype)
    return array.reshape(shape, order="F" if fortran else "C")
