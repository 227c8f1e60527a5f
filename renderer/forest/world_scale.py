"""Sizes of the forest's world, shared by its bakes, techniques and renderer."""

from __future__ import annotations

NODES = 512
"""Nodes a side of the terrain grid."""

CELL = 8.0
"""Metres between two nodes."""

CANOPY_HEIGHT = 20.0
"""Thickness of the canopy layer [m]."""

TILE_SIDE = 40.0
"""Side of the triangular tiles [m]."""

VOXEL = 0.625
"""Side of a voxel of the pattern [m]."""

PRESENCE_CELL = 4.0
"""Metres between two places of the map of trees: less than a crown."""

PRESENCE_SIDE = round(NODES * CELL / PRESENCE_CELL)
"""Places a side of the map of trees, in the middle of its cells."""

REACH = 30000.0
"""Distance [m] beyond which nothing of the forest is drawn."""

FADE = 1500.0
"""Distance [m] from the square over which the land beyond it, of which nothing is known, fades into the sky."""

STAND_TOP = 15.0
"""Height of a closed stand's surface over the ground [m]: what its edge casts on a glade."""
