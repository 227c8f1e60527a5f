"""Colour of a mesh's faces: one linear reflectance a face, from materials, textures or painted vertices."""

from __future__ import annotations

from typing import Any

import numpy as np
import trimesh

from renderer.core.errors import AssetError, LimitError
from renderer.world.image import srgb_decode
from renderer.world.limits import Limits

CHUNK = 65_536
"""Faces whose texture samples are held at once: 16 samples of 4 texels each, 50 MB."""

_UP = [((i + 1 / 3) / 4, (j + 1 / 3) / 4) for i in range(4) for j in range(4 - i)]
_DOWN = [((i + 2 / 3) / 4, (j + 2 / 3) / 4) for i in range(3) for j in range(3 - i)]
SAMPLE_POINTS = np.array(_UP + _DOWN).T
"""Where a face's texture is read: centres of the 16 triangles it splits into, as weights of corners 2 and 3."""


def face_colours(
    geometry: trimesh.Trimesh,
    base: tuple[float, float, float] | None,
    gltf: bool,
    default: tuple[float, ...],
    limits: Limits,
) -> tuple[np.ndarray, tuple[str, ...]]:
    """Linear colour of each face.

    glTF's factors and painted vertices are linear, its textures sRGB (glTF 2.0, sections 3.9.2, 3.7.2.1); colours of
    the other formats are 8-bit and taken as sRGB, as the programs that write them show them.

    Args:
        geometry: one mesh of the file.
        base: linear factor of its glTF material, None where it has none.
        gltf: whether the file is glTF.
        default: linear colour of a face whose file says nothing.
        limits: bounds the texture.

    Returns:
        (F, 3) float64 in [0, 1], and notes.

    Raises:
        AssetError: `uv` holds values that are no numbers; `texture` cannot be decoded.
        LimitError: `texture` has too many pixels.
    """
    count = len(geometry.faces)
    visual: Any = geometry.visual  # trimesh's own union: `kind` says which it is
    decode = (lambda values: values) if gltf else srgb_decode
    if visual.kind == "face":
        return decode(visual.face_colors[:, :3] / 255.0), ()
    if visual.kind == "vertex":
        return decode(visual.vertex_colors[:, :3] / 255.0)[geometry.faces].mean(axis=1), ()
    if visual.kind != "texture":
        return np.tile(default, (count, 1)), ()
    colour, notes = _textured(geometry, default if base is None else (1.0, 1.0, 1.0), limits)
    if base is not None:
        colour = colour * np.asarray(base)
    painted = visual.vertex_attributes.get("color")
    if gltf and painted is not None and len(painted) == len(geometry.vertices):
        scale = np.iinfo(painted.dtype).max if painted.dtype.kind == "u" else 1.0
        colour = colour * (painted[:, :3] / scale)[geometry.faces].mean(axis=1)
    return np.clip(colour, 0, 1), notes


def _textured(
    geometry: trimesh.Trimesh, plain: tuple[float, ...], limits: Limits
) -> tuple[np.ndarray, tuple[str, ...]]:
    """Mean colour of the texture under each face, or `plain` where there is no texture."""
    count = len(geometry.faces)
    visual: Any = geometry.visual
    material = visual.material
    picture = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
    if picture is None:
        return np.tile(np.asarray(plain, dtype=np.float64), (count, 1)), ()
    uv = visual.uv
    if uv is None or len(uv) != len(geometry.vertices):
        return np.tile(np.asarray(plain, dtype=np.float64), (count, 1)), ("a texture without coordinates was left out",)
    if not np.isfinite(uv).all():
        raise AssetError("uv", "holds texture coordinates that are no numbers", "finite numbers")
    texels, translucent = _texels(picture, limits)
    corners = np.asarray(uv, dtype=np.float64)[geometry.faces]
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    flat = int((np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) < 1e-12).sum())
    notes: tuple[str, ...] = (f"{flat:,} faces have texture coordinates without area",) if flat else ()
    notes += ("the texture's transparency was not used",) if translucent else ()
    colour = np.concatenate([_mean_texel(texels, corners[i : i + CHUNK]) for i in range(0, count, CHUNK)])
    return colour, notes


def _texels(picture: Any, limits: Limits) -> tuple[np.ndarray, bool]:
    """Linear texels (rows, columns, 3) float32 of a picture, row 0 at the top, and whether any is transparent."""
    width, height = picture.size
    if width * height > limits.texture_pixels:
        raise LimitError("texture", f"has {width:,} x {height:,} pixels", f"at most {limits.texture_pixels:,} in all")
    try:
        rgba = np.asarray(picture.convert("RGBA"))
    except (OSError, ValueError, SyntaxError) as failure:
        raise AssetError("texture", "is a damaged or truncated picture") from failure
    table = srgb_decode(np.arange(256) / 255.0).astype(np.float32)
    return table[rgba[..., :3]], bool((rgba[..., 3] < 128).any())


def _mean_texel(texels: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Mean of bilinear, repeating reads at SAMPLE_POINTS of each face.

    Args:
        texels: (rows, columns, 3). corners: (F, 3, 2) texture coordinates, v upwards.
    """
    s, t = SAMPLE_POINTS
    points = np.einsum("ks,fsd->fkd", np.stack([1 - s - t, s, t], axis=1), corners)
    rows, columns = texels.shape[:2]
    x, y = points[..., 0] * columns - 0.5, (1 - points[..., 1]) * rows - 0.5
    left, top = np.floor(x), np.floor(y)
    u, v = (x - left)[..., None], (y - top)[..., None]
    at = [
        np.mod(value, size).astype(np.int64)
        for value, size in ((top, rows), (top + 1, rows), (left, columns), (left + 1, columns))
    ]
    mixed = (texels[at[0], at[2]] * (1 - u) + texels[at[0], at[3]] * u) * (1 - v) + (
        texels[at[1], at[2]] * (1 - u) + texels[at[1], at[3]] * u
    ) * v
    return mixed.mean(axis=1)
