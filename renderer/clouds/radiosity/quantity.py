"""The quantity `radiosity`: light between two level planes cut to discs, or between relief and a level cloud."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from renderer.clouds.radiosity.bases import HALF
from renderer.clouds.radiosity.measured import by_matrices, exchange_of, on_grid, radii
from renderer.clouds.radiosity.measured_relief import level_basis, over_relief
from renderer.clouds.radiosity.two_planes import TwoPlanes, solve
from renderer.core.errors import InputError
from renderer.core.params import Model, param
from renderer.core.quantity import InputFile, Progress, Quantity, Values

Radius = Annotated[float, Field(ge=0.5, le=64)]


class RadiosityArguments(Model):
    """Two planes, and how the light between them is computed."""

    ground_albedo: float = param(
        0.3,
        label="Ground albedo",
        help="Share that the ground reflects, diffusely.",
        unit="ratio",
        cost="host",
        ge=0,
        le=1,
        source="Belcour 2009, section 5.1.3",
    )
    cloud_albedo: float = param(
        0.9,
        label="Cloud albedo",
        help="Share that the cloud base reflects, diffusely.",
        unit="ratio",
        cost="host",
        ge=0,
        le=1,
        source="Belcour 2009, section 5.1.3",
    )
    distance: float = param(
        2500.0,
        label="Distance",
        help="From the ground up to the cloud base.",
        unit="m",
        cost="host",
        ge=1,
        le=100_000,
        source="Belcour 2009, section 5.1.2",
    )
    radii: Annotated[tuple[Radius, ...], Field(min_length=1, max_length=16)] = param(
        (16.0,),
        label="Radii",
        help="Of the discs to which both planes are cut, in distances between them.",
        unit="ratio",
        cost="host",
        source="Belcour 2009, annex A.1",
    )
    bounces: int = param(
        8,
        label="Bounces",
        help="From the cloud to the ground and back; sums after each are given.",
        unit="count",
        cost="host",
        ge=1,
        le=64,
        source="Belcour 2009, section 5.2.1",
    )
    technique: Literal["exact", "fft", "three_level", "transfer"] = param(
        "exact",
        label="Technique",
        help="Quadrature over the radius, of level planes alone, or a technique of the slot `bounce`.",
        cost="host",
    )
    reading: Literal["texels", "taps", "discs"] = param(
        "taps", label="Footprints", help="How the three levels of `three_level` are read.", cost="host"
    )
    basis: Literal["object", "solid_angle", "haar"] = param(
        "haar", label="Basis", help="Functions of `transfer`.", cost="host", source="Belcour 2009, section 5.2.2"
    )
    coefficients: Literal[15, 64, 256] = param(
        256, label="Coefficients", help="Of `transfer`.", unit="count", cost="host", source="Belcour 2009, annex A.2"
    )


def _radiosity(arguments: RadiosityArguments, files: Mapping[str, Path], progress: Progress) -> Values:
    given = arguments
    if "terrain" in files:
        return over_relief(given, files["terrain"], progress)
    if given.technique == "transfer" and max(given.radii) > HALF:
        raise InputError(
            "radii",
            f"reach beyond the square of transfer, {HALF:g} distances to each side",
            f"at most {HALF:g}, or another technique",
        )
    arrays: dict[str, np.ndarray] = {}
    for k, radius in enumerate(given.radii):
        progress(k / len(given.radii), f"discs of radius {radius:g}")
        found = _sums(given, radius)
        name = f"Rc{radius:g}"
        arrays |= {
            f"r_over_H_{name}": found.radii,
            f"r_{name}_m": found.radii * given.distance,
            f"ground_cum_{name}": found.ground,
            f"cloud_cum_{name}": found.cloud,
        }
        if given.ground_albedo > 0:
            arrays[f"err_ground_{name}"] = found.ground_error
        arrays |= {
            f"err_cloud_{name}": found.cloud_error,
            "exact_ground_cum": found.endless_ground,
            "exact_cloud_cum": found.endless_cloud,
        }
    product = given.ground_albedo * given.cloud_albedo
    notes = ["the cloud starts with radiosity 1, the ground with 0; sums after each bounce, the start included"]
    if product < 1:
        total = 1 / (1 - product)
        arrays |= {"endless_ground": np.array(given.ground_albedo * total), "endless_cloud": np.array(total)}
        notes.append(f"the bounces leave out {product ** (given.bounces + 1):.3g} of the sum between endless planes")
    else:
        notes.append("between endless planes that absorb nothing there is no sum")
    return Values(arrays, tuple(notes))


def _sums(given: RadiosityArguments, radius: float) -> TwoPlanes:
    planes = given.ground_albedo, given.cloud_albedo, radius, given.bounces
    if given.technique == "exact":
        return solve(*planes, radii(radius))
    if given.technique == "transfer":
        return by_matrices(level_basis(given.basis, given.coefficients), *planes)
    return on_grid(exchange_of(given.technique, radius, given.reading), *planes)


RADIOSITY = Quantity(
    title="Radiosity between ground and cloud",
    help="Light that bounces between the ground, level or a terrain, and a level cloud base, after each bounce.",
    arguments=RadiosityArguments,
    function=_radiosity,
    units={
        "r_over_H_Rc*": "distances between the planes, from the axis",
        "r_Rc*_m": "m, from the axis",
        "ground_cum_Rc*, cloud_cum_Rc*": "radiosity summed over bounces, the cloud's first being 1; [bounce, radius]",
        "err_ground_Rc*, err_cloud_Rc*": "ratio to endless planes after as many bounces, less 1; [bounce, radius]",
        "exact_ground_cum, exact_cloud_cum": "endless planes, after each bounce",
        "endless_ground, endless_cloud": "endless planes, all bounces",
        "ground_cum, cloud_cum": "the same over a terrain; [bounce, row, column], row 0 in the north",
        "x_m, y_m": "m, east and north of the terrain's middle",
        "elevation_m": "m above the lowest point, mean of a cell",
    },
    technique="as asked: exact (Gauss-Legendre over the radius, the azimuth in closed form), fft (exact kernel over "
    "square cells of a quarter of the distance), three_level (mip levels of H, 2H and 8H), transfer (matrices "
    "in a basis on a square of 32 distances, over relief by rays)",
    source="Belcour 2009, sections 5.1.2, 5.2.2 and annex A.1; Bouthors, Neyret and Lefebvre 2006 (three levels)",
    files=(InputFile("terrain", "elevation model under the clouds, for fft, three_level and transfer"),),
    error={
        "exact": "1e-13 of each sum",
        "fft": "1e-3 of each sum inside the rim's last cell",
        "three_level": "0.03 of each sum before the rim, much more at it: the technique's own",
        "transfer": "0.3 % in the inner half of level discs of 16 (256 coefficients; 2.4 % of 8); over relief 3 % of "
        "a cell's mean",
    },
)
