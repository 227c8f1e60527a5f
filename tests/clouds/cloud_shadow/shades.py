"""A layer over a striped map, and the shade it casts by each technique and by ray and plane."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from renderer.clouds.geometry.flat import Flat
from renderer.clouds.phase.henyey_greenstein import HenyeyGreenstein
from renderer.clouds.scattering.adding_doubling import AddingDoubling
from renderer.clouds.technique import CloudsTechnique

RADIUS, BASE, THICKNESS, EXTINCTION, SIDE = 6.35e6, 1000.0, 200.0, 0.01, 8192.0
MAP = np.zeros((64, 64), np.float32)
MAP[:, 32:] = 1.0  # clouds over the eastern half

DECLARED = "\n".join(
    f"uniform {kind};"
    for kind in (
        "float planet_radius",
        "float layer_base",
        "float layer_thickness",
        "float layer_extinction",
        "vec2 cloud_drift",
        "float cloud_side",
        "float cloud_repeats",
        "float pixel_angle",
        "vec3 camera_origin",
        "float cloud_widens",
        "vec3 sun_direction",
        "sampler2D cloud_map",
        "sampler2D cloud_systems",
    )
)
FILES = ["clouds/path.glsl", "clouds/layer.glsl"]


def shade(
    ask: Callable[..., np.ndarray],
    technique: CloudsTechnique,
    east: np.ndarray,
    elevation: float,
    part: str,
    azimuth: float = 90.0,
) -> np.ndarray:
    """A part of the shade, (N,), at places east of the site under a sun in the east, degrees."""
    el, az = np.radians(elevation), np.radians(azimuth)
    sun = (np.sin(az) * np.cos(el), np.cos(az) * np.cos(el), np.sin(el))
    pictures = np.zeros((64, 64, 4), np.float32)
    pictures[..., 0] = pictures[..., 3] = MAP
    values = {
        "planet_radius": RADIUS,
        "layer_base": BASE,
        "layer_thickness": THICKNESS,
        "layer_extinction": EXTINCTION,
        "cloud_drift": (0.0, 0.0),
        "cloud_side": SIDE,
        "cloud_repeats": 1.0,
        "pixel_angle": 0.0,
        "camera_origin": (0.0, 0.0, 0.0),
        "cloud_widens": 0.0,
        "sun_direction": sun,
    }
    point = "vec3(x, 0.0, 0.0)"
    return ask(
        {"phase": HenyeyGreenstein(), "geometry": Flat(), "scattering": AddingDoubling(), "cloud_shadow": technique},
        f"cloud_shadow({point}, 0.0, sun_direction.z, cover_at(vec2(x, 0.0), 1.0).thickness).{part}",
        {"x": east},
        3,
        files=FILES,
        values=values,
        declarations=DECLARED,
        pictures={"cloud_map": pictures, "cloud_systems": np.ones((4, 4, 4), np.float32)},
    )[..., 0]
