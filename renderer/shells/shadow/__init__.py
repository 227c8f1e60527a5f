"""Techniques of the slot shadow: what the shell leaves of the sun."""
