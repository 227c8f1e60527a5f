"""Numbers that renderer and shaders of the shells share."""

from __future__ import annotations

TET_ROW = 512
"""Tetrahedra a row of the texture that holds them, as in shaders/shells/tetrahedra.glsl."""

TET_TEXELS = 8
"""Texels of each: four planes, three rows of the map to texture space, four neighbours."""

OPAQUE = 0.999
"""Opacity at which a ray ends: what lies behind would add less than a display shows."""

TOP, BASE, RIM = -1, -2, -3
"""What stands for a neighbour at the shell's boundary: its top, its base, the side of an open edge."""

MOST_LAYERS = 16
"""Times that a ray may come into the shell anew; later ones are left out."""
