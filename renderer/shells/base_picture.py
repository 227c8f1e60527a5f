"""Pictures on the surface under the shell: the Earth, or a user's own.

`earth.jpg` is NASA's Blue Marble: Next Generation (Stöckli et al. 2005, NASA Earth Observatory; in the public domain),
reduced to 1024 x 512 by means of linear light: longitude and latitude, its left edge at 180 degrees west, its top at
the north pole.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from renderer.core.cache import AssetStore
from renderer.core.errors import InputError
from renderer.core.params import Model, bake_arguments, param
from renderer.core.technique import Arrays, Bake
from renderer.shells.surfaces import ASSET
from renderer.world.image_files import load_image

EARTH = Path(__file__).parent / "earth.jpg"

MOST_TEXELS = 2048
"""Along a side of a picture as it is kept; larger ones are reduced."""

Laid = Literal["globe", "texture"]


def _turn() -> Any:
    return param(
        0.0, label="Turn", help="Of the picture eastwards about the z axis.", unit="deg", cost="host", ge=-180, le=180
    )


class NoPicture(Model):
    """One colour all over."""

    kind: Literal["none"] = "none"


class Earth(Model):
    """The Earth as seen from space without its clouds, by longitude and latitude round the world's origin."""

    kind: Literal["earth"] = "earth"
    turn: float = _turn()

    @property
    def laid(self) -> Laid:
        """How it is laid on."""
        return "globe"


class OwnPicture(Model):
    """An uploaded picture."""

    kind: Literal["asset"] = "asset"
    asset: str = param(
        ..., label="File", help="An uploaded picture, as asset:HASH.", cost="bake", pattern=ASSET, takes=("image",)
    )
    laid: Laid = param(
        "globe",
        label="Laid",
        help="By longitude and latitude round the origin; or by the surface's texture coordinates.",
        cost="host",
    )
    turn: float = _turn()
    across: float = param(
        1.0, label="Repeats across", help="Of the texture along u that a picture covers.", cost="host", gt=0, le=64
    )
    upwards: float = param(
        1.0, label="Repeats upwards", help="Of the texture along v that a picture covers.", cost="host", gt=0, le=64
    )


BasePicture = Annotated[NoPicture | Earth | OwnPicture, Field(discriminator="kind")]


def laid_by(picture: NoPicture | Earth | OwnPicture, opaque: bool) -> Laid | None:
    """How a picture is laid on; None where none is seen."""
    return None if isinstance(picture, NoPicture) or not opaque else picture.laid


def placing(picture: NoPicture | Earth | OwnPicture) -> tuple[tuple[float, float], float]:
    """Pictures a repeat of the texture along u and v, and the share of a turn by which a globe's is turned."""
    if isinstance(picture, NoPicture):
        return (1.0, 1.0), 0.0
    repeats = (1 / picture.across, 1 / picture.upwards) if isinstance(picture, OwnPicture) else (1.0, 1.0)
    return repeats, picture.turn / 360


def picture_values(picture: NoPicture | Earth | OwnPicture, centre: np.ndarray) -> dict[str, Any]:
    """Uniforms of a picture, places counted from `centre` [m]."""
    repeats, turn = placing(picture)
    return {
        "picture_centre": tuple(-float(part) for part in centre),
        "picture_turn": turn,
        "picture_repeats": repeats,
    }


def picture_bake(picture: Earth | OwnPicture) -> Bake:
    """The picture's reflectance."""
    return Bake("picture", bake_picture, bake_arguments(picture), seconds=1)


def bake_picture(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> Arrays:
    """A picture as reflectance.

    Args:
        arguments: of the document's `picture`.

    Returns:
        `picture` (H, W, 3) float32, linear, in [0, 1], row 0 at the bottom, sides of at most `MOST_TEXELS`.

    Raises:
        InputError: `picture.asset`, in words.
    """
    progress(0.1, "reading the picture")
    try:
        named = arguments.get("asset")
        path = EARTH if named is None else AssetStore().get(named.removeprefix("asset:")).path
        pixels = load_image(path)[..., :3]
    except InputError as failure:
        raise failure.at("picture.asset") from None
    for axis in (0, 1):
        if pixels.shape[axis] > MOST_TEXELS:
            pixels = reduced(pixels, MOST_TEXELS, axis)
    return {"picture": np.ascontiguousarray(np.clip(pixels, 0, 1)[::-1], dtype=np.float32)}


def reduced(values: np.ndarray, count: int, axis: int) -> np.ndarray:
    """Means of values over `count` even parts of an axis."""
    before = np.insert(np.cumsum(values, axis=axis, dtype=np.float64), 0, 0.0, axis=axis)
    ends = np.arange(count + 1) * values.shape[axis] / count
    whole = np.minimum(ends.astype(int), values.shape[axis] - 1)
    share = (ends - whole).reshape([-1 if k == axis else 1 for k in range(values.ndim)])
    sums = np.take(before, whole, axis) * (1 - share) + np.take(before, whole + 1, axis) * share
    means: np.ndarray = np.diff(sums, axis=axis) * (count / values.shape[axis])
    return means


def halves(picture: np.ndarray) -> list[np.ndarray]:
    """The picture as half floats with its coarser levels, each half the size of the one before."""
    levels = [picture]
    while max(levels[-1].shape[:2]) > 1:
        last = levels[-1]
        for axis in (0, 1):
            last = reduced(last, max(last.shape[axis] // 2, 1), axis)
        levels.append(last)
    return [level.astype(np.float16) for level in levels]
