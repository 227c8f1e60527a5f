"""How large a user's file may be: one declaration for every loader, and for the process that checks uploads."""

from __future__ import annotations

from pathlib import Path

from renderer.core.errors import AssetError, LimitError
from renderer.core.params import Model, param


class Limits(Model):
    """Bounds on what a file may hold; over them comes a LimitError that names the bound."""

    file_bytes: int = param(
        256 << 20, label="File size", help="Largest file that is opened.", unit="count", cost="host", ge=1, le=8 << 30
    )
    cells: int = param(
        64_000_000, label="Terrain nodes", help="Most nodes of an elevation model.", unit="count", cost="host", ge=4
    )
    faces: int = param(
        4_000_000,
        label="Faces",
        help="Most triangles of a mesh, instances counted each.",
        unit="count",
        cost="host",
        ge=1,
    )
    vertices: int = param(
        8_000_000,
        label="Vertices",
        help="Most vertices of a mesh, instances counted each.",
        unit="count",
        cost="host",
        ge=3,
    )
    points: int = param(
        8_000_000, label="Points", help="Most points of a cloud.", unit="count", cost="host", ge=16
    )
    voxels: int = param(64_000_000, label="Voxels", help="Most voxels of a volume.", unit="count", cost="host", ge=1)
    brdf_values: int = param(
        4_000_000,
        label="Reflectances",
        help="Most pairs of directions of a tabulated reflectance.",
        unit="count",
        cost="host",
        ge=1,
    )
    texture_pixels: int = param(
        33_554_432, label="Texture pixels", help="Most pixels of one embedded picture.", unit="count", cost="host", ge=1
    )
    worker_bytes: int = param(
        3 << 30,
        label="Memory",
        help="Address space of the process that checks an upload.",
        unit="count",
        cost="host",
        ge=1 << 28,
    )
    worker_seconds: float = param(
        30.0,
        label="Time",
        help="Time after which the check of an upload is stopped.",
        unit="s",
        cost="host",
        gt=0,
        le=600,
    )


DEFAULT_LIMITS = Limits()


class Unsaid(AssetError):
    """A sound file leaves out a value that its format has no place for; the user may still say it."""


def check_file(path: Path, limits: Limits) -> bytes:
    """The first 64 bytes of a file that exists and is not too large.

    Raises:
        AssetError: `file` is missing or empty.
        LimitError: `file` is larger than `limits.file_bytes`.
    """
    try:
        size = path.stat().st_size
        with path.open("rb") as stream:
            head = stream.read(64)
    except OSError as failure:
        raise AssetError("file", "cannot be opened") from failure
    if size == 0:
        raise AssetError("file", "is empty")
    if size > limits.file_bytes:
        raise LimitError("file", f"has {size:,} bytes", f"at most {limits.file_bytes:,} bytes")
    return head
