"""Mesh files made for the tests."""

from __future__ import annotations

import io
import json
import struct
from pathlib import Path

import numpy as np
import trimesh
from PIL import Image


def box() -> trimesh.Trimesh:
    """A box 1 x 2 x 3 m, its lowest corner at (10, 20, 30)."""
    return trimesh.creation.box(
        extents=(1, 2, 3), transform=trimesh.transformations.translation_matrix((10.5, 21, 31.5))
    )


def written(mesh: trimesh.Trimesh | trimesh.Scene, kind: str, folder: Path) -> Path:
    path = folder / f"mesh.{kind}"
    mesh.export(path)
    return path


def quad_glb(
    folder: Path,
    *,
    base: tuple[float, ...] = (1, 1, 1, 1),
    picture: Image.Image | None = None,
    image_uri: str = "",
    double_sided: bool = False,
    edit=None,
) -> Path:
    """A square in the file's xy plane made by hand, so that trimesh's writer is not its own referee."""
    position = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype="<f4").tobytes()
    uv = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], dtype="<f4").tobytes()
    index = np.array([0, 1, 2, 0, 2, 3], dtype="<u2").tobytes()
    stream = io.BytesIO()
    if picture is not None:
        picture.save(stream, "PNG")
    parts = [position, uv, index, stream.getvalue()]
    views, blob = [], b""
    for part in parts:
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(part)})
        blob += part + b"\0" * (-len(part) % 4)
    material: dict = {"pbrMetallicRoughness": {"baseColorFactor": base}, "doubleSided": double_sided}
    document: dict = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": views[:3],
        "buffers": [{"byteLength": len(blob)}],
        "materials": [material],
    }
    if picture is not None or image_uri:
        material["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
        document["textures"] = [{"source": 0}]
        document["images"] = [{"uri": image_uri} if image_uri else {"bufferView": 3, "mimeType": "image/png"}]
        document["bufferViews"] = views
    if edit is not None:
        edit(document)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    path = folder / "quad.glb"
    path.write_bytes(
        struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(blob))
        + struct.pack("<I4s", len(text), b"JSON")
        + text
        + struct.pack("<I4s", len(blob), b"BIN\0")
        + blob
    )
    return path
