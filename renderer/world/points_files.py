"""Files of points: which format one is, and its columns as they stand. Nothing is unpickled, nothing else opened."""

from __future__ import annotations

import io
import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from renderer.core.errors import AssetError, InputError, LimitError
from renderer.world.arrays import npz_names, read_npy, read_npz
from renderer.world.limits import Limits

HEADER_BYTES = 65_536
"""How far into a file the end of a PLY header is looked for."""

PLY_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}

ALIASES = {
    "position": (("x", "y", "z"),),
    "normal": (("nx", "ny", "nz"), ("normal_x", "normal_y", "normal_z")),
    "colour": (("red", "green", "blue"), ("diffuse_red", "diffuse_green", "diffuse_blue"), ("r", "g", "b")),
}
"""Names of the properties that are read."""


@dataclass(frozen=True)
class Columns:
    """What a file says of its points: (N, 3) arrays of the file's own types; None where it says nothing."""

    position: np.ndarray
    normal: np.ndarray | None = None
    colour: np.ndarray | None = None
    notes: tuple[str, ...] = field(default_factory=tuple)


def points_format(path: Path) -> str | None:
    """`ply` (without faces), `las`, `npz` or `npy` where a file holds points, by its content; else None."""
    with path.open("rb") as stream:
        head = stream.read(HEADER_BYTES)
    if head[:4] == b"LASF":
        return "las"
    if head[:4] in (b"ply\n", b"ply\r"):
        counts = dict(re.findall(rb"(?m)^element (\w+) (\d{1,18})[ \t\r]*$", head.split(b"end_header")[0]))
        return None if int(counts.get(b"face", b"0")) else "ply"
    if head[:4] == b"PK\x03\x04":
        return "npz" if "position" in npz_names(path) else None
    if head[:6] == b"\x93NUMPY":
        shape = re.search(rb"'shape': \((\d+), (\d+)\)", head[:4096])
        return "npy" if shape and int(shape.group(2)) in (3, 6, 9) and int(shape.group(1)) > 9 else None
    return None


def columns_of(path: Path, limits: Limits) -> Columns:
    """The columns of a file of points; of a PLY with faces too, which are left out.

    Raises:
        AssetError, LimitError: in words.
    """
    with path.open("rb") as stream:
        mark = stream.read(6)
    kind = "ply" if mark[:4] in (b"ply\n", b"ply\r") else points_format(path)
    if kind is None:
        raise AssetError("file", "holds no points that can be read", "PLY, LAS, LAZ, .npz with position, .npy")
    try:
        return {"ply": _ply, "las": _las, "npz": _npz, "npy": _npy}[kind](path, limits)
    except InputError:
        raise
    except MemoryError as failure:
        raise LimitError("file", "needs more memory than a cloud of points may") from failure
    except Exception as failure:  # laspy raises whatever a damaged file leads it to
        raise AssetError("file", f"is a damaged or truncated {kind.upper()} file") from failure


def _npz(path: Path, limits: Limits) -> Columns:
    found = read_npz(path, ("position", "normal", "colour"), limits.points * 24)
    for name, array in found.items():
        if array.dtype.kind not in "iuf":
            raise AssetError(name, f"is {array.dtype}", "numbers")
    return Columns(found["position"], found.get("normal"), found.get("colour"))


def _npy(path: Path, limits: Limits) -> Columns:
    table = read_npy(path, "position", limits.points * 72)
    if table.dtype.kind not in "iuf" or table.ndim != 2:
        raise AssetError("position", f"is {table.dtype} of shape {table.shape}", "numbers, a row a point")
    normal, colour = (table[:, k : k + 3] if table.shape[1] > k else None for k in (3, 6))
    notes = () if normal is None else ("columns are read as position, normal and colour",)
    return Columns(table[:, :3], normal, colour, notes)


def _las(path: Path, limits: Limits) -> Columns:
    """Points of a LAS or LAZ file (ASPRS LAS 1.4), with their colours where the format has them."""
    import laspy  # a quarter of a second, which only these files should cost

    with laspy.open(path) as reader:
        if reader.header.point_count > limits.points:
            raise LimitError("position", f"has {reader.header.point_count:,} points", f"at most {limits.points:,}")
        table = reader.read()
    if len(table.points) != reader.header.point_count:
        raise AssetError("position", f"is cut short: {len(table.points):,} of {reader.header.point_count:,} points")
    position = np.stack([np.asarray(table.x), np.asarray(table.y), np.asarray(table.z)], axis=1)
    if "red" not in set(table.point_format.dimension_names):
        return Columns(position)
    colour = np.stack([np.asarray(table.red), np.asarray(table.green), np.asarray(table.blue)], axis=1)
    if not colour.any():
        return Columns(position, notes=("its colours are all black and were left out",))
    if colour.max() <= 255:  # the standard asks for 16 bits; many programs leave 8 as they are
        colour = colour.astype(np.uint8)
    return Columns(position, colour=colour)


def _ply(path: Path, limits: Limits) -> Columns:
    data = path.read_bytes()
    end = re.search(rb"end_header[ \t]*\r?\n", data[:HEADER_BYTES])
    if end is None:
        raise AssetError("file", "is cut short within its PLY header")
    head, body = data[: end.start()].decode("latin-1"), memoryview(data)[end.end():]
    said = re.search(r"(?m)^format (ascii|binary_little_endian|binary_big_endian) 1\.0", head)
    elements = re.split(r"(?m)^element ", head)[1:]
    if said is None or not elements or not re.match(r"vertex \d{1,18}\s", elements[0]):
        raise AssetError("file", "does not begin with its points", "PLY 1.0 whose first element is vertex")
    count = int(elements[0].split()[1])
    if count > limits.points:
        raise LimitError("position", f"has {count:,} points", f"at most {limits.points:,}")
    names, types = [], []
    for line in re.findall(r"(?m)^property (.*?)[ \t\r]*$", elements[0]):
        words = line.split()
        if len(words) != 2 or words[0] not in PLY_TYPES:
            raise AssetError("file", f"has a property of points that is not one number: {line[:40]}", "plain numbers")
        types.append(PLY_TYPES[words[0]])
        names.append(words[1].lower())
    if len(set(names)) != len(names):
        raise AssetError("file", "names a property of its points twice")
    notes = ("its faces were left out",) if "face " in "".join(elements[1:]) else ()
    return _picked(_table(body, said.group(1), count, names, types), notes)


def _table(body: memoryview, said: str, count: int, names: list[str], types: list[str]) -> dict[str, np.ndarray]:
    """The properties of points (N,) by name."""
    if said != "ascii":
        order = "<" if "little" in said else ">"
        record = np.dtype([(name, order + kind) for name, kind in zip(names, types)])
        if len(body) < count * record.itemsize:
            raise AssetError("position", f"is cut short: {len(body) // record.itemsize:,} of {count:,} points")
        rows = np.frombuffer(body, record, count)
        return {name: rows[name] for name in names}
    text = io.BytesIO(body)
    lines = [line for line, _ in zip(text, range(count))]
    values = np.array(b" ".join(lines).split(), dtype=np.float64)
    if len(lines) != count or len(values) != count * len(names):
        raise AssetError("position", f"is cut short or uneven: {len(lines):,} of {count:,} lines")
    table = values.reshape(count, len(names))
    return {name: table[:, k].astype(kind if kind[0] in "iu" else "f8")
            for k, (name, kind) in enumerate(zip(names, types))}


def _picked(table: dict[str, np.ndarray], notes: tuple[str, ...]) -> Columns:
    found = {}
    for what, choices in ALIASES.items():
        for names in choices:
            if all(name in table for name in names):
                found[what] = np.stack([table[name] for name in names], axis=1)
                break
    if "position" not in found:
        raise AssetError("position", "is missing: the points have no x, y and z")
    return Columns(found["position"], found.get("normal"), found.get("colour"), notes)
