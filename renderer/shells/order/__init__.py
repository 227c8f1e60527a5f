"""Techniques of the slot order: in which order a ray's segments are put together."""
