// No filtering. Cohen 2004, section 6.6 ("en éliminant toute forme de mipmapping").
// Symbols: footprint width of the pixel at the point [m].

float filter_level(float footprint) {
    return 0.0;
}
