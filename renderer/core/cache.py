"""What was computed once and what users brought: a cache of arrays and a store of uploaded files.

Both are folders that any number of processes share. Names follow from contents, so nothing is ever overwritten by
something different, and nothing needs invalidating.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import json
import os
import re
import struct
import time
import zipfile
import zlib
from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from renderer.core.errors import AssetError, LimitError
from renderer.core.files import locked, sweep, write_atomically

HASH = re.compile(r"[0-9a-f]{64}")


def key_of(*parts: Any) -> str:
    """The cache key of some plain JSON values: the SHA-256 of their canonical text, as 64 hexadecimal digits.

    Raises:
        ValueError, TypeError: a NaN, an infinity or something that is no JSON.
    """
    text = json.dumps(parts, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def default_folder() -> Path:
    """$UMBRAGE_CACHE, or `umbrage` in the user's cache folder."""
    if named := os.environ.get("UMBRAGE_CACHE"):
        return Path(named)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "umbrage"


class Cache:
    """Named arrays by key, one uncompressed `.npz` a key.

    A damaged file (each array carries a CRC-32) is deleted and counts as a miss; a killed writer leaves nothing that a
    reader could take for a result. When the files together exceed the limit, those unused longest go first.

    Args:
        folder: where; made when first written. By default `default_folder()`.
        limit_bytes: size that the whole may reach, in bytes. The newest entry stays even when it alone exceeds it.
    """

    def __init__(self, folder: Path | None = None, limit_bytes: int = 4 << 30) -> None:
        self.folder = Path(folder) if folder is not None else default_folder()
        self.limit_bytes = limit_bytes

    def path(self, key: str) -> Path:
        """Where the entry of `key` lies, or would."""
        if not HASH.fullmatch(key):
            raise ValueError(f"not a cache key: {key!r}")
        return self.folder / "arrays" / key[:2] / f"{key}.npz"

    def lock(self, key: str, waiting: Callable[[], None] | None = None) -> AbstractContextManager[None]:
        """The lock that whoever computes `key` holds, so that it is computed once (`waiting`: see `files.locked`).

        Some keys share one of 4096 locks, which bounds their number; whoever holds one must ask for no other.
        """
        return locked(self.folder / "locks" / self.path(key).stem[:3], waiting)

    def __contains__(self, key: str) -> bool:
        return self.path(key).is_file()

    def get(self, key: str) -> dict[str, np.ndarray] | None:
        """The arrays stored under `key`, or None. Reading keeps an entry from being evicted."""
        path = self.path(key)
        try:
            with zipfile.ZipFile(path) as archive:
                # Read whole before it is parsed: only then is the check sum known to hold.
                arrays = {name.removesuffix(".npy"): _parse(archive.read(name)) for name in archive.namelist()}
                if archive.comment != _index(arrays):
                    raise zipfile.BadZipFile("an array is missing")
            os.utime(path)
        except FileNotFoundError:
            return None
        except (OSError, ValueError, EOFError, NotImplementedError, struct.error, zipfile.BadZipFile, zlib.error):
            path.unlink(missing_ok=True)
            return None
        return arrays

    def put(self, key: str, arrays: Mapping[str, np.ndarray]) -> None:
        """Store `arrays` under `key`.

        Raises:
            ValueError: an array of Python objects, which could only be stored as code to execute.
        """

        def write(file: BinaryIO) -> None:
            with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
                archive.comment = _index(arrays)
                for name, array in arrays.items():
                    with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                        np.lib.format.write_array(member, np.asarray(array), allow_pickle=False)

        write_atomically(self.path(key), write)
        self._evict(keep=self.path(key))

    def _evict(self, keep: Path) -> None:
        with locked(self.folder / "evict.lock"):
            sweep(self.folder / "arrays")
            entries = []
            for path in (self.folder / "arrays").glob("*/*.npz"):
                with contextlib.suppress(FileNotFoundError):
                    facts = path.stat()
                    entries.append((facts.st_mtime_ns, facts.st_size, path))
            total = sum(size for _, size, _ in entries)
            for _, size, path in sorted(entries):
                if total <= self.limit_bytes:
                    break
                if path != keep:
                    path.unlink(missing_ok=True)
                    total -= size


def _index(names: Iterable[str]) -> bytes:
    """The comment of an entry's archive: the names in it, because no check sum covers the archive's own list."""
    return key_of(*sorted(names)).encode()


def _parse(data: bytes) -> np.ndarray:
    array: np.ndarray = np.lib.format.read_array(io.BytesIO(data), allow_pickle=False)
    return array


SUFFIXES = (".binary", ".csv", ".exr", ".glb", ".gltf", ".hdr", ".jpeg", ".jpg", ".json", ".las", ".laz", ".npy",
            ".npz", ".obj", ".off", ".ply", ".png", ".stl", ".tif", ".tiff", ".zip")
"""Endings of the files that some loader reads. Only these become part of a stored file's name."""


class Asset(NamedTuple):
    """A stored upload.

    Attributes:
        path: the file; its ending is the upload's.
        kind: what it is used for, as `terrain` or `mesh`.
        name: what its owner called it; for people only.
        expires: when it goes if nobody uses it before, in seconds since 1970.
    """

    path: Path
    kind: str
    name: str
    expires: float


class AssetStore:
    """Files that users brought, by content hash, under a quota, each gone some time after its last use.

    Args:
        folder: where; made when first written.
        quota_bytes: size of all assets together, in bytes; over it an upload is refused.
        lifetime_s: how long an asset stays after its last use, s.
    """

    def __init__(self, folder: Path | None = None, quota_bytes: int = 1 << 30, lifetime_s: float = 7 * 86400.0) -> None:
        self.folder = Path(folder) if folder is not None else default_folder() / "assets"
        self.quota_bytes = quota_bytes
        self.lifetime_s = lifetime_s

    def put(self, data: bytes, kind: str, name: str) -> str:
        """Store a file that was already checked, and return its hash.

        The hash covers kind and ending beside the bytes: the three decide what a loader makes of the file.

        Raises:
            AssetError: no loader reads files of that ending.
            LimitError: the store is full.
        """
        suffix = Path(name).suffix.lower()
        if suffix not in SUFFIXES:
            raise AssetError("file", "files of this type are not read", " ".join(SUFFIXES))
        digest = hashlib.sha256(json.dumps([kind, suffix]).encode() + data).hexdigest()
        note = json.dumps({"kind": kind, "name": name[:200], "suffix": suffix, "bytes": len(data)}).encode()
        with locked(self.folder / "put.lock"):
            self._purge()
            used = sum(entry["bytes"] for entry in self.list() if entry["hash"] != digest)
            if used + len(data) > self.quota_bytes:
                raise LimitError("file", "the store of uploaded files is full",
                                 f"at most {max(self.quota_bytes - used, 0)} bytes until others expire")
            # The note comes last: an asset exists once its note does.
            write_atomically(self.folder / f"{digest}{suffix}", lambda file: _write(file, data))
            write_atomically(self.folder / f"{digest}.note", lambda file: _write(file, note))
        return digest

    def get(self, digest: str) -> Asset:
        """The asset with that hash; using it puts off its expiry.

        Raises:
            AssetError: there is none (any more).
        """
        path = self.folder / f"{digest}.note"
        try:
            if not HASH.fullmatch(digest) or self._expires(path) < time.time():
                raise FileNotFoundError
            note = json.loads(path.read_bytes())
            file = self.folder / f"{digest}{note['suffix']}"
            if file.stat().st_size != note["bytes"]:
                raise FileNotFoundError
            os.utime(path)
        except (FileNotFoundError, ValueError, KeyError):
            raise AssetError("asset", "there is no uploaded file with this hash, or it has expired") from None
        return Asset(file, note["kind"], note["name"], self._expires(path))

    def list(self) -> list[dict[str, Any]]:
        """Every asset: hash, kind, name, bytes and expires (seconds since 1970), the next to expire first."""
        found = []
        for path in self.folder.glob("*.note"):
            with contextlib.suppress(FileNotFoundError, ValueError, KeyError):
                note = json.loads(path.read_bytes())
                found.append({"hash": path.stem, "kind": note["kind"], "name": note["name"], "bytes": note["bytes"],
                              "expires": self._expires(path)})
        return sorted(found, key=lambda entry: entry["expires"])

    def _expires(self, note: Path) -> float:
        return note.stat().st_mtime + self.lifetime_s

    def _purge(self) -> None:
        sweep(self.folder)
        for entry in self.list():
            if entry["expires"] < time.time():
                for path in self.folder.glob(f"{entry['hash']}.*"):
                    path.unlink(missing_ok=True)


def _write(file: BinaryIO, data: bytes) -> None:
    file.write(data)
