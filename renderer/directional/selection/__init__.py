"""Which points are seen, texel by texel or pixel by pixel."""
