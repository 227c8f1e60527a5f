"""The quantity `hemisphere`: what a code keeps of a shadow hemisphere, and what it makes of it again."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from renderer.core.errors import AssetError, InputError, LimitError
from renderer.core.params import Model, param
from renderer.core.quantity import InputFile, Progress, Quantity, Values
from renderer.directional.codes.baking import CODE_SIZES, MAKERS
from renderer.directional.codes.code import cells_of
from renderer.directional.codes.harmonics import ringing
from renderer.directional.hemisphere import Hemisphere, hemisphere_of
from renderer.directional.shadow_hemispheres import cosine_weights
from renderer.world.arrays import read_npz
from renderer.world.limits import DEFAULT_LIMITS, check_file

MOST = 20_000
"""Most hemispheres at once."""

LEARNING = ("chosen", "codebook", "spherical_harmonics")
"""Codes that are fitted to all hemispheres given."""

Bit = Annotated[int, Field(ge=0, le=1)]
Height = Annotated[float, Field(ge=-90, le=90)]
WORDS = "bits of 0 and 1, one a direction, or horizon_rad by azimuth"


class HemisphereArguments(Model):
    """A mask of directions, and the code that it is put into."""

    directions: Literal[129, 513] = param(
        129, label="Directions", help="Of a hemisphere.", unit="count", cost="host", source="Porquet 2005"
    )
    code: Literal[
        "bits", "chosen", "codebook", "exact_harmonics", "harmonics", "horizon_ring", "spherical_harmonics"
    ] = param("harmonics", label="Code", help="As the slot self_shadow has it.", cost="host")
    size: Literal[5, 9, 17, 33] = param(
        9, label="Bytes", help="Of a hemisphere; unread by codes that leave no choice.", unit="count", cost="host"
    )
    bits: Annotated[tuple[Bit, ...], Field(max_length=513)] = param(
        (),
        label="Bits",
        help="Of one hemisphere, 1 where light arrives: rows of azimuths from the horizon up, the zenith last.",
        cost="host",
    )
    horizon: Annotated[tuple[Height, ...], Field(max_length=720)] = param(
        (),
        label="Horizon",
        help="Instead: its elevation in even steps of azimuth from the first axis towards the second, degrees.",
        cost="host",
    )


def _hemisphere(given: HemisphereArguments, files: Mapping[str, Path], progress: Progress) -> Values:
    progress(0.0, "reading hemispheres")
    layout = hemisphere_of(given.directions)
    masks = _masks(given, files, layout)
    sizes = CODE_SIZES[given.code]
    if sizes != (0,) and given.size not in sizes:
        raise InputError("size", f"{given.code} has no {given.size} bytes", ", ".join(map(str, sizes)))
    progress(0.2, "coding hemispheres")
    code = MAKERS[given.code](layout, given.size, masks)
    words = code.encode(masks)
    progress(0.6, "reading codes")
    raw = code.evaluate(words, cells_of(layout))
    shown, judged, weights = np.clip(raw, 0, 1), raw > 0.5, cosine_weights(layout)
    directions = layout.directions()
    share, worst = ringing(raw)
    notes = [f"{code.size} bytes a hemisphere; {float((judged != masks).mean()):.2%} of all directions misjudged",
             f"before the clamp {share:.2%} leave 0 to 1 by more than a tenth, the worst by {worst:.3g}"]  # fmt: skip
    if given.code in LEARNING:
        notes.append(f"fitted to the {len(masks):,} hemispheres given: few are kept better than a cloud's would be")
    arrays = {
        "direction": directions,
        "elevation_rad": np.arcsin(directions[:, 2]),
        "azimuth_rad": np.arctan2(directions[:, 1], directions[:, 0]) % (2 * np.pi),
        "bits": masks.astype(np.uint8),
        "code": words.view(np.uint8)[:, : code.size],
        "reconstructed": raw,
        "judged": judged.astype(np.uint8),
        "misjudged": (judged != masks).mean(axis=1),
        "rms": np.sqrt(((shown - masks) ** 2).mean(axis=1)),
        "openness": masks @ weights,
        "openness_reconstructed": shown @ weights,
    }
    return Values(arrays, tuple(notes))


def _masks(given: HemisphereArguments, files: Mapping[str, Path], layout: Hemisphere) -> np.ndarray:
    """Masks (M, count) of the one source that is given."""
    said = [name for name in ("bits", "horizon") if getattr(given, name)] + [name for name in files if name == "masks"]
    if len(said) != 1:
        raise InputError("bits", f"{len(said) or 'none'} of three ways to give hemispheres is used",
                         "one of bits, horizon and the file masks")  # fmt: skip
    if said[0] == "masks":
        return read_masks_file(files["masks"], layout)
    if said[0] == "horizon":
        return above(np.radians([given.horizon]), layout)
    if len(given.bits) != layout.count:
        raise InputError("bits", f"are {len(given.bits)}", f"{layout.count}, one a direction")
    return np.array([given.bits], bool)


def above(horizon: np.ndarray, layout: Hemisphere) -> np.ndarray:
    """Masks (M, count) of directions over horizons (M, A) [rad] in even steps of azimuth, linear between them."""
    count = horizon.shape[1]
    place = np.arange(layout.azimuths) * count / layout.azimuths
    first = np.floor(place).astype(int)
    low, high = horizon[:, first], horizon[:, (first + 1) % count]
    height = low + (high - low) * (place - first)
    lit = layout.elevation()[None, :, None] > height[:, None]
    zenith = horizon.max(axis=1) < np.pi / 2
    return np.concatenate([lit.reshape(len(horizon), -1), zenith[:, None]], axis=1)


def read_masks_file(path: Path, layout: Hemisphere) -> np.ndarray:
    """Masks (M, count) from an .npz with `bits` (M, count) or `horizon_rad` (M, A), or a CSV of bits.

    Raises:
        AssetError: anything else. LimitError: more than `MOST`.
    """
    try:
        if check_file(path, DEFAULT_LIMITS).startswith(b"PK"):
            data = read_npz(path, ("bits", "horizon_rad"), MOST * 8 * 720)
            name = "bits" if "bits" in data else "horizon_rad"
            found = np.atleast_2d(np.asarray(data[name], np.float64))
        else:
            rows = list(csv.reader(io.StringIO(path.read_text(encoding="utf-8-sig"))))
            name, found = "bits", np.array([row for row in rows if row], np.float64)
    except InputError as failure:
        raise failure.at("masks") from None
    except (KeyError, ValueError, UnicodeDecodeError):
        raise AssetError("masks", "hold no such numbers", WORDS) from None
    if found.ndim != 2 or not found.size or not np.isfinite(found).all():
        raise AssetError("masks", f"are of shape {found.shape}, or not numbers throughout", WORDS)
    if len(found) > MOST:
        raise LimitError("masks", f"are {len(found):,} hemispheres", f"at most {MOST:,}")
    if name == "horizon_rad":
        if found.shape[1] > 720 or np.abs(found).max() > np.pi / 2 + 1e-9:
            raise AssetError("masks", "hold a horizon out of range", "at most 720 azimuths, -pi/2 to pi/2")
        return above(found, layout)
    if found.shape[1] != layout.count or not np.isin(found, (0, 1)).all():
        raise AssetError("masks", f"hold {found.shape[1]} values a hemisphere", f"{layout.count} of 0 and 1")
    return np.asarray(found > 0)


HEMISPHERE = Quantity(
    title="Shadow hemisphere in a code",
    help="What bits, harmonics, rings and learnt patterns keep of a point's shadow hemisphere in so many bytes, and "
    "what they make of it again.",
    arguments=HemisphereArguments,
    function=_hemisphere,
    units={
        "direction": "unit vectors; [direction, (first axis, second axis, normal)]",
        "elevation_rad, azimuth_rad": "rad; [direction], above the horizon and from the first axis to the second",
        "bits": "0 or 1; [hemisphere, direction], what is given",
        "code": "bytes; [hemisphere, byte], in the order of the code's bits",
        "reconstructed": "1; [hemisphere, direction], before any clamp: what rings leaves 0 to 1",
        "judged": "0 or 1; [hemisphere, direction], reconstructed over a half",
        "misjudged, rms": "1; [hemisphere], share of its directions, all alike; of the clamped shadow function",
        "openness, openness_reconstructed": "1; [hemisphere], share of an even sky's irradiance",
    },
    technique="as the slot self_shadow reads its codes",
    source="Porquet 2005, section 3.3.2.3, with erratum 003-5; Max 1988; Linde, Buzo & Gray 1980; Sloan, Kautz & "
    "Snyder 2002",
    error={
        "code": "none: the layout is documented in renderer/directional/codes",
        "reconstructed": "1e-12 of the code's own value; the GPU's differs by up to 5e-3, by its arc sine",
    },
    files=(InputFile("masks", "an .npz with bits [point, direction] or horizon_rad [point, azimuth]; a CSV of bits"),),
)
"""The quantity `hemisphere`."""
