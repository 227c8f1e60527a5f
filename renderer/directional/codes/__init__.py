"""Codes of shadow hemispheres: what is kept of a point's mask of directions, in how many bytes, and how it is read."""
