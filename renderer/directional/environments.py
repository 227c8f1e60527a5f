"""What surrounds the subject and shines on it: the scene's sky, a built-in picture of all directions, or one's own.

A picture is equirectangular: row 0 at the zenith, columns by azimuth clockwise from its own north.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, TypeAdapter

from renderer.core.cache import AssetStore
from renderer.core.errors import InputError
from renderer.core.params import Model, bake_arguments, param, radians_of
from renderer.core.technique import Arrays, Bake
from renderer.directional.environment_light import harmonics_of, sky_harmonics, smoothed
from renderer.directional.environment_pictures import PICTURES, ROWS, resampled
from renderer.world.atmosphere import bilinear
from renderer.world.image_files import load_image
from renderer.world.sky import SkyNow, sky_radiance

ASSET = r"^asset:[0-9a-f]{64}$"


class SceneSky(Model):
    """The scene's own sky, without the sun; below the horizon it repeats the horizon."""

    kind: Literal["sky"] = "sky"
    level: float = param(1.0, label="Level", help="What its radiance is multiplied by.", cost="host", ge=0, le=1e4)


class _Picture(Model):
    rotation: float = param(
        0.0, label="Rotation", help="Clockwise about the zenith.", unit="deg", cost="host", ge=-360, le=360
    )
    level: float = param(
        100.0, label="Level", help="Radiance that 1 in it stands for.", unit="W m-2 sr-1", cost="host", ge=0, le=1e6
    )


class Studio(_Picture):
    """A dim room with a broad soft light, two strips and a pale floor."""

    kind: Literal["studio"] = "studio"


class Evening(_Picture):
    """A low bright sun behind haze, a wide glow over dark hills, and a blue sky opposite."""

    kind: Literal["evening"] = "evening"


class Own(_Picture):
    """An uploaded picture of all directions."""

    kind: Literal["picture"] = "picture"
    asset: str = param(
        ...,
        label="File",
        help="An uploaded equirectangular picture (HDR, EXR, .npy; PNG or JPEG without bright lights), as asset:HASH.",
        cost="bake",
        pattern=ASSET,
        takes=("image",),
    )


AnyEnvironment = SceneSky | Studio | Evening | Own
Environment = Annotated[AnyEnvironment, Field(discriminator="kind")]

_ANY: TypeAdapter[AnyEnvironment] = TypeAdapter(Environment)


def environment_bake(environment: AnyEnvironment) -> list[Bake]:
    """The precomputation of a picture; none of the sky's, which follows the sun."""
    if environment.kind == "sky":
        return []
    return [Bake("environment", bake_environment, bake_arguments(environment), version=2, seconds=4)]


def bake_environment(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> dict[str, np.ndarray]:
    """A picture with what is precomputed of it, of radiance as its file has it.

    Args:
        arguments: an `Environment` with a picture, as a document.

    Returns:
        `image` (ROWS, 2 ROWS, 3) float32; `levels`, how many smoother ones there are, and `level_1`, ..., each half the
        size; `harmonics` (18, 3) of the irradiance.
    """
    environment = _ANY.validate_python(arguments)
    progress(0.05, "reading the surroundings")
    image = user_picture(environment.asset) if isinstance(environment, Own) else PICTURES[environment.kind]()
    levels = smoothed(image, lambda share: progress(0.1 + 0.8 * share, "smoothing the surroundings"))
    found = {f"level_{number}": level.astype(np.float32) for number, level in enumerate(levels, start=1)}
    return {
        "image": image.astype(np.float32),
        "levels": np.array(len(levels)),
        "harmonics": harmonics_of(image),
        **found,
    }


def user_picture(asset: str) -> np.ndarray:
    """An uploaded picture, (ROWS, 2 ROWS, 3).

    Raises:
        InputError: it cannot be had, or covers no whole sphere.
    """
    try:
        picture = load_image(AssetStore().get(asset.removeprefix("asset:")).path)[..., :3].astype(np.float64)
    except InputError as failure:
        raise failure.at("environment.asset") from None
    height, width = picture.shape[:2]
    if abs(width - 2 * height) > 2 or height < 8:
        raise InputError(
            "environment.asset", f"is {width} x {height} pixels", "an equirectangular picture: twice as wide as high"
        )
    if picture.min() < 0:
        raise InputError("environment.asset", "holds negative light")
    return resampled(picture, ROWS)


def image_of(environment: AnyEnvironment, baked: Mapping[str, Arrays], now: SkyNow, sun: np.ndarray) -> np.ndarray:
    """Radiance (rows, columns, 3) [W m-2 sr-1] of all directions, columns clockwise from the picture's own north.

    Args:
        baked: arrays of the bakes by name. now, sun: the sky of the moment and the unit vector to the sun.
    """
    if environment.kind != "sky":
        return np.asarray(baked["environment"]["image"], np.float64) * environment.level
    polar, azimuth = (np.arange(ROWS) + 0.5) / ROWS * math.pi, (np.arange(2 * ROWS) + 0.5) / ROWS * math.pi
    level, azimuth = np.sin(polar)[:, None], azimuth[None]
    parts = np.broadcast_arrays(level * np.sin(azimuth), level * np.cos(azimuth), np.cos(polar)[:, None])
    return np.asarray(sky_radiance(now, sun, np.stack(parts, axis=-1)) * environment.level)


def rotation_of(environment: AnyEnvironment) -> float:
    """By which a picture is turned clockwise about the zenith [rad]."""
    return 0.0 if environment.kind == "sky" else radians_of(environment, "rotation")


def background_of(
    state: Any, baked: Mapping[str, Arrays], now: SkyNow, sun: np.ndarray
) -> Callable[[np.ndarray], np.ndarray]:
    """Radiance (..., 3) [W m-2 sr-1] behind the subject by unit directions (..., 3), without the sun's disc."""
    if not shows_picture(state):
        return lambda ways: sky_radiance(now, sun, ways)
    image, turn = image_of(state.environment, baked, now, sun), rotation_of(state.environment)
    rows, columns = image.shape[:2]
    closed = np.concatenate([image[:, -1:], image, image[:, :1]], axis=1)

    def behind(ways: np.ndarray) -> np.ndarray:
        across = np.mod((np.arctan2(ways[..., 0], ways[..., 1]) - turn) / (2 * math.pi), 1.0) * columns
        down = np.arccos(np.clip(ways[..., 2], -1, 1)) / math.pi * rows
        return bilinear(closed, np.clip(down - 0.5, 0, rows - 1), across + 0.5)

    return behind


def shows_picture(state: Any) -> bool:
    """Whether a picture stands behind the subject: where the light takes it, and the background is no flat one."""
    return state.environment.kind != "sky" and state.light.kind in ("environment", "combined")


def environment_macros(state: Any) -> dict[str, str]:
    """What of the surroundings is compiled in."""
    sky, behind = state.environment.kind == "sky", shows_picture(state)
    return {"ENVIRONMENT_SKY": str(int(sky)), "ENVIRONMENT_BEHIND": str(int(behind))}


DECLARATIONS = """uniform vec4 environment_said;     // cosine and sine of the rotation, radiance of 1, coarsest level
uniform vec3 environment_harmonics[18]; // of the irradiance, W m-2, in the picture's own frame"""


def environment_values(
    environment: AnyEnvironment, baked: Mapping[str, Arrays], now: SkyNow, sun: np.ndarray
) -> dict[str, Any]:
    """Values of `DECLARATIONS`; the sky's own frame has the sun in the north."""
    if environment.kind == "sky":
        turn, found, coarsest = math.atan2(sun[0], sun[1]), sky_harmonics(now), 0.0
    else:
        turn, found = rotation_of(environment), baked["environment"]["harmonics"]
        coarsest = float(baked["environment"]["levels"])
    said = (math.cos(turn), math.sin(turn), environment.level, coarsest)
    return {"environment_said": said, "environment_harmonics": np.asarray(found) * environment.level}
