"""Techniques of the slot light: how matter answers the light."""
