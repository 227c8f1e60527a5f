"""Directional textures: a point cloud drawn from what each face of its box sees (Porquet 2005)."""
