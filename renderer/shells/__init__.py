"""Shells: semi-transparent 3D textures over any mesh (Dufort 2005)."""
