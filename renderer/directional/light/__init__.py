"""Techniques of the slot light: how a point returns the light that reaches it."""
