"""Uploads: what a stranger's file is, and whether it can be trusted, found out in a process with nothing to lose."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal, get_args

from renderer.core.cache import AssetStore
from renderer.core.errors import AssetError, InputError, LimitError
from renderer.world.arrays import npz_names
from renderer.world.brdf_files import is_merl
from renderer.world.image_files import MAGIC
from renderer.world.limits import DEFAULT_LIMITS, Limits, check_file
from renderer.world.maps import QUANTITIES
from renderer.world.mesh_formats import FORMATS as MESH_FORMATS
from renderer.world.mesh_formats import mesh_format
from renderer.world.points import FORMATS as POINTS_FORMATS
from renderer.world.points_files import points_format
from renderer.world.terrain_files import png_header, terrain_format
from renderer.world.volume_stack import stack_names

Kind = Literal["terrain", "mesh", "volume", "image", "map", "brdf", "points"]
"""What files are read as; each kind has a loader in this package."""

READ = (
    f"a terrain (GeoTIFF, 16-bit grey PNG, .npz with elevation), a mesh ({MESH_FORMATS}), a volume (.npz with rgba, or "
    f"a .zip of PNG layers), a map (.npz with {', '.join(QUANTITIES)}), a reflectance (a MERL file, .npz with brdf), "
    f"a cloud of points ({POINTS_FORMATS}), or a picture (PNG, JPEG, HDR, EXR, .npy)"
)

WANTED = ("elevation (a terrain), rgba (a volume), brdf (a reflectance), position (points), or a map: "
          f"{', '.join(QUANTITIES)}")
"""Arrays of which an .npz must have one."""

REFUSED = {
    b"%PDF": "is a PDF document",
    b"\x1f\x8b": "is a gzip archive: unpack it first",
    b"\x28\xb5\x2f\xfd": "is a zstd archive: unpack it first",
    b"\x89HDF": "is an HDF5 file, for which there is no loader",
    b"CDF": "is a NetCDF file, for which there is no loader",
    b"\x80": "is or may be a pickle, which is never opened",
}
"""Files that people are likely to bring by mistake, by their first bytes."""

ANSWER_BYTES = 65_536
"""Longest answer taken from the checking process: a preview has well under a kilobyte."""


def recognise(path: Path, filename: str = "", limits: Limits = DEFAULT_LIMITS) -> Kind:
    """What kind of file an upload is, by its content.

    Args:
        path: the file.
        filename: the name its owner gave it; only the ending .stl is used, for a binary STL has no mark.
        limits: bounds on its size.

    Raises:
        AssetError: a kind without a loader, in words.
        LimitError: too many bytes.
    """
    head = check_file(path, limits)
    kind = terrain_format(head)
    if kind == "tiff":
        return "terrain"
    if kind == "png":
        return "terrain" if png_header(head)[2:] == (16, 0) else "image"
    if kind == "npz":
        names = npz_names(path)
        if "elevation" in names or "rgba" in names:
            return "terrain" if "elevation" in names else "volume"
        if "brdf" in names:
            return "brdf"
        if any(name in names for name in QUANTITIES):
            return "map"
        if stack_names(path):
            return "volume"
        if "position" in names:
            return "points"
        held = ", ".join(name[:40] for name in names[:5]) or "none"
        raise AssetError("file", f"is an archive with the arrays: {held}", WANTED)
    if is_merl(head):
        return "brdf"
    if points_format(path) is not None:
        return "points"
    if any(head.startswith(magic) for magic, _ in MAGIC):
        return "image"
    if mesh_format(path.read_bytes(), filename) is not None:
        return "mesh"
    words = next((words for mark, words in REFUSED.items() if head.startswith(mark)), "is of no known kind")
    raise AssetError("file", words, READ)


def check_in_worker(
    path: Path, kind: str, limits: Limits = DEFAULT_LIMITS, reading: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """Load a file in a process of its own, bounded in memory and time, and tell what it holds.

    Args:
        path: the file.
        kind: one of `Kind`.
        limits: bounds on the file and on the process.
        reading: fields of the kind's reading (TerrainReading, MeshReading, ...) that the file leaves unsaid.

    Returns:
        a preview in JSON values: format, sizes with their units, counts, what is still to be said, and notes.

    Raises:
        AssetError, LimitError: what the loader found, or that it did not survive the file.
    """
    if kind not in get_args(Kind):
        raise AssetError("kind", f"{kind[:40]!r} has no loader", ", ".join(get_args(Kind)))
    root = Path(__file__).resolve().parents[2]
    task = {"path": str(path.resolve()), "kind": kind, "limits": limits.model_dump(), "reading": dict(reading or {})}
    # The parent's environment holds the server's secrets; one thread keeps BLAS from reserving memory for a pool.
    environment = {"PYTHONPATH": str(root), "OPENBLAS_NUM_THREADS": "1", "PATH": os.defpath}
    with tempfile.TemporaryDirectory(prefix="umbrage-check-") as folder:
        environment["MPLCONFIGDIR"] = folder
        command = [sys.executable, "-m", "renderer.world.upload_worker"]
        with subprocess.Popen(
            command,
            cwd=folder,
            env=environment,
            start_new_session=True,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        ) as process:
            try:
                output, _ = process.communicate(json.dumps(task).encode(), timeout=limits.worker_seconds)
            except subprocess.TimeoutExpired as failure:
                raise LimitError("file", "took too long to check", f"at most {limits.worker_seconds:g} s") from failure
            finally:
                if process.poll() is None:
                    os.killpg(process.pid, signal.SIGKILL)  # it leads a session of its own, with whatever it started
    return _answer(output, limits)


def _answer(output: bytes, limits: Limits) -> dict[str, Any]:
    """The preview, or the error that the process met."""
    try:
        answer = json.loads(output[:ANSWER_BYTES])
    except ValueError as failure:  # killed by its limits, or crashed inside a decoder: it left no words
        raise AssetError(
            "file",
            "could not be read within the memory and time that a file may take",
            f"{limits.worker_bytes >> 20} MB and {limits.worker_seconds:g} s",
        ) from failure
    if "error" in answer:
        error = answer["error"]
        kind: type[InputError] = LimitError if answer.get("limit") else AssetError
        raise kind(str(error["field"]), str(error["message"]), str(error["allowed"]))
    preview: dict[str, Any] = answer["preview"]
    return preview


def admit(store: AssetStore, path: Path, filename: str, reading: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """Check an uploaded file in a process of its own and keep it.

    Args:
        store: where.
        path: the file.
        filename: what its owner calls it.
        reading: fields of its kind's reading that the file leaves unsaid, as `{"holes": "fill"}`; a document that
            uses the file has to say them too.

    Returns:
        Its `asset` (as documents name it), kind, name, `reading` as given, preview, and when it `expires` unless it
        is used (seconds since 1970).

    Raises:
        AssetError, LimitError: what is wrong with it, in words.
    """
    said = dict(reading or {})
    kind = recognise(path, filename)
    preview = check_in_worker(path, kind, reading=said)
    digest = store.put(path.read_bytes(), kind, filename)
    return {
        "asset": f"asset:{digest}",
        "kind": kind,
        "name": filename,
        "reading": said,
        "preview": preview,
        "expires": store.get(digest).expires,
    }
