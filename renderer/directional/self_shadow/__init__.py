"""Techniques of the slot self_shadow: what the subject hides of a distant light from its own points."""
