"""Mesh files: which format one is, what its header claims, and trimesh's scene of it. Nothing else is opened."""

from __future__ import annotations

import io
import json
import logging
import re
import struct
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import trimesh

from renderer.core.errors import AssetError, InputError, LimitError
from renderer.world.limits import Limits

FORMATS = "glTF (.glb, or .gltf with everything embedded), OBJ, PLY, STL or OFF"

GLB_JSON, GLB_BINARY = 0x4E4F534A, 0x004E4942

READABLE_EXTENSIONS = re.compile(r"KHR_materials_\w+|KHR_texture_transform")
"""glTF extensions that change shading only: a file that requires others holds geometry that would be misread."""

Colour = tuple[float, float, float]

HEADER_BYTES = 65_536
"""How far into a file a format's marks are looked for."""

# trimesh logs what it skips in a stranger's file; `notes` and errors say it in words.
logging.getLogger("trimesh").setLevel(logging.CRITICAL)


@dataclass(frozen=True)
class Parsed:
    """A mesh file as trimesh sees it.

    Args:
        scene: geometry and the transforms of its instances, in the file's own axes and unit.
        format: `gltf`, `obj`, `ply`, `stl` or `off`.
        base_colours: linear RGB factor of each glTF material, by number; empty for other formats.
        notes: what was left out, in words.
    """

    scene: trimesh.Scene
    format: str
    base_colours: tuple[Colour, ...] = ()
    notes: tuple[str, ...] = ()


class _NothingElse(Mapping[str, bytes]):
    """A resolver that opens no file, and remembers which were asked for."""

    def __init__(self) -> None:
        self.asked: list[str] = []

    def __getitem__(self, name: str) -> bytes:
        self.asked.append(str(name)[:80])
        raise FileNotFoundError(name)

    def get(self, name: str, default: Any = None) -> Any:
        """Refuse like `[]`: trimesh reads textures through `get` and must not receive None for bytes."""
        return self[name]

    def __iter__(self) -> Iterator[str]:
        return iter(())

    def __len__(self) -> int:
        return 0


def mesh_format(data: bytes, name: str = "") -> str | None:
    """The format of a mesh file by its content, or None.

    Args:
        data: the whole file.
        name: its name; only the ending .stl is used, for a binary STL cut short has no other mark.
    """
    head = data[:HEADER_BYTES]
    if head[:4] == b"glTF":
        return "glb"
    if head[:4] in (b"ply\n", b"ply\r"):
        return "ply"
    if re.match(rb"\s*(C?OFF)\s", head):
        return "off"
    if head.lstrip()[:1] == b"{" and b'"asset"' in data and b'"version"' in data:
        return "gltf"
    if re.match(rb"\s*solid\b", head) and (b"facet" in head or b"endsolid" in head):
        return "stl"
    if len(data) >= 84 and len(data) == 84 + 50 * struct.unpack("<I", data[80:84])[0]:
        return "stl"
    if b"\0" not in head and re.search(rb"(?m)^[ \t]*v[ \t]+[-+.0-9]", head):
        return "obj"
    return "stl" if name.lower().endswith(".stl") else None


def parse_mesh(data: bytes, limits: Limits, name: str = "") -> Parsed:
    """Let trimesh read a file whose claims were checked first.

    Args:
        data: the whole file. name: its name, for a broken STL.

    Raises:
        AssetError: `file` is of no known format, damaged, or cut short; `faces`, where its header promises more.
        LimitError: the header promises more faces or vertices than allowed.
    """
    kind = mesh_format(data, name)
    if kind is None:
        raise AssetError("file", "is no mesh that can be read", FORMATS)
    try:
        promised = 0
        notes: list[str] = []
        colours: tuple[Colour, ...] = ()
        if kind in ("glb", "gltf"):
            data, colours, notes = _checked_gltf(data, kind, limits)
        elif kind in ("ply", "off"):
            promised = _promised(data, kind, limits)
        elif kind == "stl":
            _check_stl(data, limits)
        else:
            _check_count(len(re.findall(rb"(?m)^[ \t]*f[ \t]", data)), limits.faces, "faces")
            _check_count(len(re.findall(rb"(?m)^[ \t]*v[ \t]", data)), limits.vertices, "vertices")
        nothing_else = _NothingElse()
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            scene = trimesh.load_scene(io.BytesIO(data), file_type=kind, resolver=nothing_else, process=False)
    except InputError:
        raise
    except MemoryError as failure:
        raise LimitError("file", "needs more memory than a mesh may") from failure
    except Exception as failure:  # trimesh raises whatever a damaged file leads it to
        raise AssetError("file", f"is a damaged or truncated {kind.upper()} file") from failure
    read = sum(len(geometry.faces) for geometry in scene.geometry.values() if isinstance(geometry, trimesh.Trimesh))
    if read < promised:
        raise AssetError("faces", f"are cut short: {read:,} of the {promised:,} that the header promises")
    notes += [f"{asked} is another file and was not read" for asked in dict.fromkeys(nothing_else.asked)]
    return Parsed(scene, "gltf" if kind == "glb" else kind, colours, tuple(notes))


def _check_count(count: int, most: int, field: str) -> None:
    if count > most:
        raise LimitError(field, f"number {count:,}", f"at most {most:,}")


def _promised(data: bytes, kind: str, limits: Limits) -> int:
    """Faces that the header of a PLY or OFF file promises."""
    head = data[:HEADER_BYTES].decode("latin-1")
    if kind == "ply":
        if "end_header" not in head:
            raise AssetError("file", "is cut short within its PLY header")
        counts = {name: int(count) for name, count in re.findall(r"(?m)^element (\w+) (\d{1,18})[ \t\r]*$", head)}
        vertices, faces = counts.get("vertex", 0), counts.get("face", 0)
    else:
        numbers = re.match(r"\s*C?OFF\s+(\d{1,18})\s+(\d{1,18})", re.sub(r"#[^\n]*", "", head))
        if numbers is None:
            raise AssetError("file", "is cut short within its OFF header")
        vertices, faces = int(numbers.group(1)), int(numbers.group(2))
    _check_count(vertices, limits.vertices, "vertices")
    _check_count(faces, limits.faces, "faces")
    return faces


def _check_stl(data: bytes, limits: Limits) -> None:
    if re.match(rb"\s*solid\b", data) and b"endsolid" in data[-256:]:
        _check_count(data.count(b"facet"), 2 * limits.faces, "faces")  # the word opens and closes each face
        return
    promised = struct.unpack("<I", data[80:84])[0] if len(data) >= 84 else 0
    if len(data) != 84 + 50 * promised:
        raise AssetError("file", "is an STL file cut short: its length is not that of the faces it promises")
    _check_count(promised, limits.faces, "faces")


def _checked_gltf(data: bytes, kind: str, limits: Limits) -> tuple[bytes, tuple[Colour, ...], list[str]]:
    """A glTF file fit for trimesh: its materials named by number, its claims within limits, nothing outside it.

    Returns:
        the file, the linear base colour factors of its materials, and notes.
    """
    document, rest = _split_glb(data) if kind == "glb" else (json.loads(data), b"")
    if not isinstance(document, dict):
        raise AssetError("file", "is no glTF document")
    required = [str(name)[:60] for name in document.get("extensionsRequired", [])]
    foreign = [name for name in required if not READABLE_EXTENSIONS.fullmatch(name)]
    if foreign:
        raise AssetError(
            "file", f"requires the glTF extension {foreign[0]}", "glTF 2.0 without compressed or quantised geometry"
        )
    notes = []
    for buffer in document.get("buffers", []):
        if not str(buffer.get("uri", "data:")).startswith("data:"):
            raise AssetError("file", "keeps its geometry in another file", ".glb, or .gltf with its buffers embedded")
    for image in document.get("images", []):
        if not str(image.get("uri", "data:")).startswith("data:"):
            notes.append(f"{str(image['uri'])[:80]} is another file and was not read")
    held = sum(int(accessor["count"]) for accessor in document.get("accessors", []))
    # A vertex has at most a dozen attributes, and each face three indices.
    _check_count(held, 12 * limits.vertices + 3 * limits.faces, "vertices")
    colours: list[Colour] = []
    for number, material in enumerate(document.get("materials", [])):
        material["name"] = str(number)
        factor = material.get("pbrMetallicRoughness", {}).get("baseColorFactor", (1, 1, 1, 1))
        red, green, blue = (min(max(float(channel), 0.0), 1.0) for channel in factor[:3])
        colours.append((red, green, blue))
        if "KHR_texture_transform" in json.dumps(material):
            notes.append(f"the texture transform of material {number} was not applied")
    text = json.dumps(document).encode()
    if kind == "gltf":
        return text, tuple(colours), notes
    text += b" " * (-len(text) % 4)
    chunk = struct.pack("<II", len(text), GLB_JSON) + text
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunk) + len(rest)) + chunk + rest, tuple(colours), notes


def _split_glb(data: bytes) -> tuple[Any, bytes]:
    """The JSON document of a .glb file, and the chunks after it (glTF 2.0, section 4.4)."""
    if len(data) < 20:
        raise AssetError("file", "is cut short within its glTF header")
    _, version, length, json_length, json_type = struct.unpack("<4sIIII", data[:20])
    if version != 2 or json_type != GLB_JSON:
        raise AssetError("file", f"is glTF version {version}", "version 2")
    if length > len(data):
        raise AssetError("file", f"is cut short: {len(data):,} of {length:,} bytes")
    return json.loads(data[20 : 20 + json_length]), data[20 + json_length : length]
