"""Techniques of the slot accumulation: how precisely colours are put together."""
