"""Sizes of the planet and of its maps, in metres."""

from __future__ import annotations

PLANET_RADIUS = 6.35e6
"""Radius of the ground (Belcour 2009, section 4; below the true polar radius, errata 001-23)."""

AIR_TOP = 1e5
"""Altitude above which there is no air, m: that of `renderer.world.atmosphere`."""

LAND_NODES, LAND_CELL = 512, 50.0
"""Nodes and their distance of the square of land around the site, 25.6 km a side."""

LAND_RIM = 3000.0
"""Over which the land comes down to the sphere at the square's edge, m."""

CLOUD_NODES = 1024
"""Texels a side of the cloud maps."""

