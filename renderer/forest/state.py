"""The forest's whole state document."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from renderer.core.params import Colour, Model, bake_arguments, param
from renderer.core.registry import slot_union
from renderer.forest.nursery import listed
from renderer.world.atmosphere import Atmosphere
from renderer.world.camera import Camera, Orbit
from renderer.world.mesh import MeshReading
from renderer.world.state import SceneState
from renderer.world.terrain import TerrainReading

Macros = tuple[tuple[str, int], ...]

SLOTS = ("geometry", "shadow", "height_shading", "light", "sky", "filter")
DEFAULTS = {
    "geometry": "ray_march",
    "shadow": "voxel_transmittance",
    "height_shading": "none",
    "light": "leaf",
    "sky": "ambient",
    "filter": "mipmap",
}
"""Each with the values that it has alone, none of them fitted to a picture."""


class BuiltInTerrain(Model):
    """A square of the elevation model that comes with the program."""

    kind: Literal["built_in"] = "built_in"
    name: Literal["jacksboro_fault"] = param(
        "jacksboro_fault", label="Model", help="Elevation model near Jacksboro, Tennessee.", cost="bake"
    )


class UserTerrain(Model):
    """A square of an uploaded elevation model."""

    kind: Literal["asset"] = "asset"
    asset: str = param(
        ..., label="File", help="An uploaded terrain, as asset:HASH.", cost="bake", pattern=r"^asset:[0-9a-f]{64}$"
    )
    east: float = param(
        0.0, label="East", help="Centre of the square, from the model's centre.", unit="m", cost="bake", ge=-1e6, le=1e6
    )
    north: float = param(
        0.0,
        label="North",
        help="Centre of the square, from the model's centre.",
        unit="m",
        cost="bake",
        ge=-1e6,
        le=1e6,
    )
    reading: TerrainReading = param(TerrainReading(), label="Reading", help="What the file leaves unsaid.", cost="bake")


Terrain = Annotated[BuiltInTerrain | UserTerrain, Field(discriminator="kind")]


class Cover(Model):
    """Where trees may stand."""

    clearings: float = param(
        0.08,
        label="Clearings",
        help="Share of the land left open in glades and meadows.",
        unit="ratio",
        cost="bake",
        ge=0,
        le=1,
        step=0.01,
    )
    glade_size: float = param(
        260.0,
        label="Size of the glades",
        help="Length over which forest turns to meadow and back.",
        unit="m",
        cost="bake",
        ge=20,
        le=2000,
    )
    steepest: float = param(
        48.0, label="Steepest slope", help="Trees stand on no steeper ground.", unit="deg", cost="bake", ge=5, le=89
    )
    tree_line: float = param(
        9000.0, label="Tree line", help="No trees above this elevation.", unit="m", cost="bake", ge=-500, le=9000
    )
    tree_line_width: float = param(
        60.0,
        label="Width of the tree line",
        help="Difference in elevation over which the forest thins out.",
        unit="m",
        cost="bake",
        ge=1,
        le=1000,
    )
    tree_line_aspect: float = param(
        0.0,
        label="Tree line on southern slopes",
        help="How much higher the tree line runs on slopes that face south; below 0 for the southern hemisphere.",
        unit="m",
        cost="bake",
        ge=-500,
        le=500,
    )
    seed: int = param(7, label="Seed", help="Of the glades' shapes.", cost="bake", ge=0, le=2**31 - 1)
    density_map: str = param(
        "",
        label="Density map",
        help="An uploaded picture, as asset:HASH, stretched over the square: no trees in black, all in white.",
        cost="bake",
        pattern=r"^(asset:[0-9a-f]{64})?$",
    )
    density_full: float = param(
        0.0,
        label="Value of a closed forest",
        help="What the density map has for it, as 100 for per cent; 0 takes the largest value of the file's type.",
        cost="bake",
        ge=0,
        le=1e6,
    )
    species_map: str = param(
        "",
        label="Species map",
        help="An uploaded raster of whole numbers, as asset:HASH, stretched over the square: 1 where only broadleaf "
        "stands, 2 conifer, 3 birch (of own trees, their numbers), 0 where all are mixed. The pixel at a tree's foot "
        "counts.",
        cost="bake",
        pattern=r"^(asset:[0-9a-f]{64})?$",
    )
    canopy_model: str = param(
        "",
        label="Canopy height model",
        help="An uploaded raster of the canopy's height over the ground, as asset:HASH. Where it reaches, the forest "
        "grows where it says, as tall as it says.",
        cost="bake",
        pattern=r"^(asset:[0-9a-f]{64})?$",
    )
    canopy_reading: TerrainReading = param(
        TerrainReading(), label="Reading of the canopy heights", help="What its file leaves unsaid.", cost="bake"
    )
    lowest_tree: float = param(
        2.0,
        label="Lowest tree",
        help="Height above which the canopy height model counts as forest.",
        unit="m",
        cost="bake",
        ge=0.5,
        le=20,
    )


    @property
    def local_heights(self) -> bool:
        """Whether trees are taller at one place than at another."""
        return bool(self.canopy_model)


class Canopy(Model):
    """The pattern of texture cells."""

    broadleaf: float = param(
        1.0, label="Broadleaf", help="Weight in the mixture of species.", unit="ratio", cost="bake", ge=0, le=1
    )
    conifer: float = param(
        0.8, label="Conifer", help="Weight in the mixture of species.", unit="ratio", cost="bake", ge=0, le=1
    )
    birch: float = param(
        0.4, label="Birch", help="Weight in the mixture of species.", unit="ratio", cost="bake", ge=0, le=1
    )
    mesh: str = param(
        "",
        label="Own trees",
        help="Uploaded meshes, as asset:HASH, up to eight with spaces between; they replace the built-in species.",
        cost="bake",
        pattern=r"^(asset:[0-9a-f]{64}( asset:[0-9a-f]{64}){0,7})?$",
    )
    reading: MeshReading = param(
        MeshReading(), label="Reading of the own tree", help="What its file leaves unsaid.", cost="bake"
    )
    density: float = param(
        1.0, label="Density", help="Of the stand, against a closed forest.", unit="ratio", cost="bake", ge=0.1, le=1.5
    )
    seed: int = param(1, label="Seed", help="Of the trees' places and shapes.", cost="bake", ge=0, le=2**31 - 1)


class Ground(Model):
    """What shows between the trees."""

    albedo: Colour = param((0.10, 0.10, 0.045), label="Ground albedo", help="Reflectance of the soil and the grass.")
    tint_strength: float = param(
        0.35, label="Tree tint", help="How much one tree's colour differs from the next.", unit="ratio", ge=0, le=0.9
    )
    translucency: float = param(
        0.7,
        label="Translucent leaves",
        help="What a leaf lets through in green, as a share of what it reflects; wood lets nothing through.",
        unit="ratio",
        ge=0,
        le=1.5,
        step=0.05,
        source="Féret et al. 2017, PROSPECT-D, at oak, spruce and birch leaves",
    )
    glow: Colour = param(
        (0.75, 1.0, 0.05),
        label="Colour of the light through leaves",
        help="As shares of the leaves' own colour: pigments take blue first.",
        source="Féret et al. 2017, PROSPECT-D",
    )
    patches: float = param(
        0.2, label="Ground patches", help="How much the ground's brightness varies.", unit="ratio", ge=0, le=0.9
    )
    map_seed: int = param(
        0, label="Map seed", help="Of the hash that lays the tiles.", cost="host", ge=0, le=2**31 - 1
    )


def _slot(name: str, title: str, help_text: str) -> Any:
    return param({"kind": DEFAULTS[name]}, label=title, help=help_text, cost="host")


class ForestState(SceneState):
    """State of the forest: where one looks from, the sun, the land, the trees, and one technique per slot."""

    scene: Literal["forest"] = "forest"
    camera: Camera = param(
        Orbit(target=(200.0, 200.0, 280.0), distance=2300.0, azimuth=140.0, elevation=30.0),
        label="Camera",
        help="Where the picture is taken from.",
        cost="host",
    )
    terrain: Terrain = param(BuiltInTerrain(), label="Terrain", help="The land.", cost="bake")
    cover: Cover = param(Cover(), label="Cover", help="Where trees may stand.", cost="bake")
    air: Atmosphere = param(Atmosphere(), label="Air", help="What sun and sky shine through.", cost="bake")
    canopy: Canopy = param(Canopy(), label="Trees", help="What grows there.", cost="bake")
    ground: Ground = param(Ground(), label="Ground and tint", help="Ground colour and the trees' own.")
    geometry: slot_union("forest", "geometry") = _slot("geometry", "Geometry", "How the canopy is sampled along a ray.")  # type: ignore[valid-type]
    shadow: slot_union("forest", "shadow") = _slot("shadow", "Shadow", "Who hides the sun from whom.")  # type: ignore[valid-type]
    height_shading: slot_union("forest", "height_shading") = _slot(  # type: ignore[valid-type]
        "height_shading", "Height shading", "Light by height in the canopy."
    )
    light: slot_union("forest", "light") = _slot("light", "Light", "How a leaf answers the sun.")  # type: ignore[valid-type]
    sky: slot_union("forest", "sky") = _slot("sky", "Sky light", "How the sky lights the canopy.")  # type: ignore[valid-type]
    filter: slot_union("forest", "filter") = _slot(  # type: ignore[valid-type]
        "filter", "Filtering", "Which level of the pattern a distance deserves."
    )

    @property
    def macros(self) -> Macros:
        """What the programs are built for: local heights, and how many canopies a species map tells apart."""
        planted = sum(listed(bake_arguments(self.canopy)).values())
        species = 1 + planted if self.cover.species_map else 0
        return ("LOCAL_CANOPY", int(self.cover.local_heights)), ("SPECIES_MAP", species)

    def techniques(self) -> dict[str, Any]:
        """The chosen technique of each slot."""
        return {slot: getattr(self, slot) for slot in SLOTS}

    def first_sample(self) -> ForestState:
        """What the first sample of its picture is drawn as."""
        return self.model_copy(
            update={"geometry": self.geometry.first_sample(), "shadow": self.shadow.first_sample()}
        )
