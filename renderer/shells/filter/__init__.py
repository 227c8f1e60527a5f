"""Techniques of the slot filter: which level of the texture is read."""
