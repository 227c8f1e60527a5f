"""The clouds as the registry finds them: their slots, presets, bakes and renderer."""

from __future__ import annotations

from collections.abc import Mapping

from renderer.clouds.bakes import bakes, world_bakes
from renderer.clouds.presets import PRESETS
from renderer.clouds.probe import probe
from renderer.clouds.renderer import CloudsRenderer
from renderer.clouds.state import DEFAULTS, CloudsState
from renderer.clouds.world_arrays import NEEDS, world_arrays
from renderer.core.technique import Arrays, Phenomenon, Slot
from renderer.world import sky
from renderer.world.sun import angles

SLOTS = (
    Slot(
        "geometry",
        "Geometry",
        "How long a ray runs through the layer.",
        "float geometry_leg(Path path, int leg, float base, float thickness, float cosine, float end); "
        "float geometry_slant(float mu, float base, float thickness) // m",
        DEFAULTS["geometry"],
    ),
    Slot(
        "phase",
        "Phase function",
        "Where a droplet sends light.",
        "vec3 phase_value(float cosine); vec3 phase_twice(float cosine) // 1/sr, integral one",
        DEFAULTS["phase"],
    ),
    Slot(
        "scattering",
        "Scattering",
        "What the layer makes of the light.",
        "vec3 scattering_up(Slab s); vec3 scattering_down(Slab s) // 1/sr: radiance per irradiance normal to the beam",
        DEFAULTS["scattering"],
    ),
    Slot(
        "cloud_shadow",
        "Cloud shadow",
        "What the layer leaves to the ground.",
        "Shade cloud_shadow(vec3 point, float altitude, float mu, float overhead) // shares of sun and sky",
        DEFAULTS["cloud_shadow"],
    ),
    Slot(
        "basis",
        "Basis",
        "Functions by which transfer matrices describe bounced light; other bounces need none.",
        "vec3 basis_ground(vec2 at); vec3 basis_cloud(vec2 at) // W m-2 at a place of the square, -1 to 1",
        DEFAULTS["basis"],
    ),
    Slot(
        "bounce",
        "Bounce",
        "Light that goes between ground and clouds.",
        "vec3 bounce_ground(vec2 place, BounceHere here); vec3 bounce_cloud(vec2 place, BounceHere here) // W m-2",
        DEFAULTS["bounce"],
    ),
)


def _metered_light(state: CloudsState, baked: Mapping[str, Arrays]) -> float:
    """Light of sun and sky on open ground, W m-2."""
    return sky.metered_light(baked["sky"], angles(state.sun)[1])


PHENOMENON = Phenomenon(
    name="clouds",
    title="Clouds",
    help="A layer of clouds round the Earth, from the valley to space, and the light between it and the ground.",
    slots=SLOTS,
    state=CloudsState,
    presets=PRESETS,
    bakes=bakes,
    open=CloudsRenderer,
    world=world_arrays,
    world_needs=NEEDS,
    world_bakes=world_bakes,
    metered_light=_metered_light,
    probe=probe,
    place=1,
)
