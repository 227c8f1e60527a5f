"""What may be said about the planet, its land and its layer of clouds: models of the state document."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from renderer.clouds.world_scale import PLANET_RADIUS
from renderer.core.params import Colour, Model, param
from renderer.world.terrain import TerrainReading

ASSET = r"^asset:[0-9a-f]{64}$"


class Layer(Model):
    """The layer of clouds."""

    base: float = param(
        2500.0, label="Base", help="Height of the clouds' base above the ground.", unit="m", ge=50, le=15000, step=50
    )
    thickness: float = param(
        100.0, label="Thickness", help="Of the layer, where its map says one.", unit="m", ge=0, le=2000, step=5
    )
    extinction: float = param(
        0.05,
        label="Extinction",
        help="Share of light that a metre of cloud takes from a beam; 0.05 is a mean free path of 20 m.",
        unit="m-1",
        ge=0,
        le=0.3,
        step=0.005,
        source="Bouthors, Neyret and Lefebvre 2006: 0.3 g/m3 of water in droplets of 10 um",
    )
    relief: float = param(
        0.5,
        label="Relief",
        help="How much the slopes of its upper side lean the layer towards the sun or away.",
        unit="ratio",
        ge=0,
        le=1,
    )
    ends: float = param(
        0.0,
        label="Ends after",
        help="Distance from the site to the front at which the clouds end; 0 lets them go on round the Earth.",
        unit="m",
        cost="host",
        ge=0,
        le=1.0e7,
        step=5000,
    )
    ends_azimuth: float = param(
        270.0, label="Ends towards", help="Where the front lies, from north by east.", unit="deg", cost="host", ge=-360,
        le=360,
    )
    wind: float = param(8.0, label="Wind", help="Speed at which it drifts.", unit="m s-1", cost="host", ge=0, le=80)
    wind_azimuth: float = param(
        70.0, label="Wind to", help="Where it drifts, from north by east.", unit="deg", cost="host", ge=-360, le=360
    )


class UniformClouds(Model):
    """The same thickness everywhere."""

    kind: Literal["uniform"] = "uniform"


class ProceduralClouds(Model):
    """Clouds drawn by chance."""

    kind: Literal["procedural"] = "procedural"
    style: Literal["stratus", "stratocumulus"] = param(
        "stratocumulus", label="Kind", help="An even sheet, or closed cells.", cost="bake"
    )
    cover: float = param(
        0.8, label="Cover", help="Share of the sky that they close.", unit="ratio", cost="host", ge=0, le=1, step=0.01
    )
    variation: float = param(
        0.35,
        label="Variation",
        help="How much the thickness varies inside a cloud.",
        unit="ratio",
        cost="host",
        ge=0,
        le=1,
    )
    cell_size: float = param(
        2500.0, label="Size of the cells", help="Distance from cloud to cloud.", unit="m", cost="bake", ge=500, le=20000
    )
    side: float = param(
        64000.0,
        label="Period",
        help="Side of the square after which the map repeats.",
        unit="m",
        cost="bake",
        ge=8000,
        le=256000,
    )
    systems: bool = param(
        True, label="Weather systems", help="Open and closed skies over thousands of kilometres.", cost="bake"
    )
    evolution: float = param(
        1.0,
        label="Evolution",
        help="How fast clouds come and go as time runs; 0 lets them drift only.",
        unit="ratio",
        cost="host",
        ge=0,
        le=10,
    )
    seed: int = param(3, label="Seed", help="Of the clouds' places.", cost="bake", ge=0, le=2**31 - 1)


class UserClouds(Model):
    """An uploaded map of the thickness."""

    kind: Literal["asset"] = "asset"
    asset: str = param(
        ...,
        label="File",
        help="An uploaded picture, raster or array `thickness`, as asset:HASH.",
        cost="bake",
        pattern=ASSET,
        takes=("map", "image", "terrain"),
    )
    side: float = param(
        64000.0,
        label="Side",
        help="Width of the square that it covers, around the site.",
        unit="m",
        cost="host",
        ge=1000,
        le=2e7,
    )
    full: float = param(
        0.0,
        label="Value of the layer's thickness",
        help="What the map has for it; 0 takes the largest value of the file's type.",
        cost="bake",
        ge=0,
        le=1e6,
    )
    repeats: bool = param(False, label="Repeats", help="Goes on beyond its edges; clear sky otherwise.", cost="host")


Clouds = Annotated[UniformClouds | ProceduralClouds | UserClouds, Field(discriminator="kind")]


class FlatLand(Model):
    """No land but the sphere."""

    kind: Literal["flat"] = "flat"


class BuiltInLand(Model):
    """A square of the elevation model that comes with the program."""

    kind: Literal["built_in"] = "built_in"
    name: Literal["jacksboro_fault"] = param(
        "jacksboro_fault", label="Model", help="Elevation model near Jacksboro, Tennessee.", cost="bake"
    )
    relief: float = param(
        1.0, label="Relief", help="Heights against the model's own.", unit="ratio", cost="bake", ge=0, le=4, step=0.1
    )


class UserLand(Model):
    """A square of an uploaded elevation model."""

    kind: Literal["asset"] = "asset"
    asset: str = param(
        ..., label="File", help="An uploaded terrain, as asset:HASH.", cost="bake", pattern=ASSET, takes=("terrain",)
    )
    east: float = param(
        0.0, label="East", help="The site, from the model's centre.", unit="m", cost="bake", ge=-1e6, le=1e6
    )
    north: float = param(
        0.0, label="North", help="The site, from the model's centre.", unit="m", cost="bake", ge=-1e6, le=1e6
    )
    relief: float = param(
        1.0, label="Relief", help="Heights against the model's own.", unit="ratio", cost="bake", ge=0, le=4, step=0.1
    )
    reading: TerrainReading = param(TerrainReading(), label="Reading", help="What the file leaves unsaid.", cost="bake")


Land = Annotated[FlatLand | BuiltInLand | UserLand, Field(discriminator="kind")]


class Planet(Model):
    """The planet, and the site where its ground is looked at from near."""

    radius: float = param(
        PLANET_RADIUS,
        label="Radius",
        help="Of the ground.",
        unit="m",
        ge=1e5,
        le=1e7,
        source="Belcour 2009, section 4",
    )
    latitude: float = param(36.5, label="Latitude", help="Of the site.", unit="deg", cost="host", ge=-90, le=90)
    longitude: float = param(-84.2, label="Longitude", help="Of the site.", unit="deg", cost="host", ge=-180, le=180)
    albedo: Colour = param(
        (0.06, 0.085, 0.04),
        label="Ground albedo",
        help="Around the site, below the snow.",
        source="Oke 1987, table 1.1",
    )
    snow_line: float = param(
        9000.0,
        label="Snow line",
        help="Height above which snow lies, above the site's lowest point.",
        unit="m",
        ge=-100,
        le=9000,
    )
    snow_albedo: Colour = param(
        (0.82, 0.84, 0.86), label="Snow albedo", help="Reflectance of snow.", source="Oke 1987, table 1.1"
    )
    rock_albedo: Colour = param(
        (0.13, 0.12, 0.11), label="Rock albedo", help="Where it is too steep for soil and snow.", source="Oke 1987"
    )
    steepest: float = param(
        50.0, label="Steepest ground", help="Slope above which soil and snow slide off.", unit="deg", ge=0, le=90
    )
    site_size: float = param(
        60000.0,
        label="Size of the site",
        help="Radius within which the ground has the albedo above; beyond it, that of the Earth.",
        unit="m",
        ge=1000,
        le=3e7,
    )
