"""The quantity `radiosity`: light bouncing between two level planes that are cut to discs."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from renderer.clouds.radiosity.measured import exchange_of, two_planes
from renderer.core.params import Model, param
from renderer.core.quantity import Progress, Quantity, Values

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
    technique: Literal["exact", "fft", "three_level"] = param(
        "exact", label="Technique", help="Quadrature over the radius, or a technique of the slot `bounce`.", cost="host"
    )
    reading: Literal["texels", "taps", "discs"] = param(
        "taps", label="Footprints", help="How the three levels of `three_level` are read.", cost="host"
    )


def _radiosity(arguments: RadiosityArguments, files: Mapping[str, Path], progress: Progress) -> Values:
    given = arguments
    arrays: dict[str, np.ndarray] = {}
    for k, radius in enumerate(given.radii):
        progress(k / len(given.radii), f"discs of radius {radius:g}")

        def exchange(radius: float = radius):
            return exchange_of(given.technique, radius, given.reading)

        found = two_planes(given.technique, given.ground_albedo, given.cloud_albedo, radius, given.bounces, exchange)
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


RADIOSITY = Quantity(
    title="Radiosity between ground and cloud",
    help="Light that bounces between level ground and a level cloud base, both cut to discs, after each bounce.",
    arguments=RadiosityArguments,
    function=_radiosity,
    units={
        "r_over_H_Rc*": "distances between the planes, from the axis",
        "r_Rc*_m": "m, from the axis",
        "ground_cum_Rc*, cloud_cum_Rc*": "radiosity summed over bounces, the cloud's first being 1; [bounce, radius]",
        "err_ground_Rc*, err_cloud_Rc*": "ratio to endless planes after as many bounces, less 1; [bounce, radius]",
        "exact_ground_cum, exact_cloud_cum": "endless planes, after each bounce",
        "endless_ground, endless_cloud": "endless planes, all bounces",
    },
    technique="as asked: exact (Gauss-Legendre over the radius, the azimuth in closed form), fft (exact kernel over "
    "square cells of a quarter of the distance), three_level (mip levels of H, 2H and 8H)",
    source="Belcour 2009, sections 5.1.2, 5.2.2 and annex A.1; Bouthors, Neyret and Lefebvre 2006 (three levels)",
    error={
        "exact": "1e-13 of each sum",
        "fft": "1e-3 of each sum inside the rim's last cell",
        "three_level": "0.03 of each sum before the rim, much more at it: the technique's own",
    },
)
