"""Techniques of the slot sampling: how a segment of a ray reads the texture."""
