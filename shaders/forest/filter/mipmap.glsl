// Mip levels of the pattern. Williams 1983; Meyer & Neyret 1998; Cohen 2004, section 6.5.
// Symbols: footprint width of the pixel at the point [m]; voxel_size [m]; level 0 is the finest.
// The bias moves the distance at which levels begin: added to level 0 as well, it made near trees 3 % too dark.
// Levels are made in renderer/forest/seen_levels.py.
// Does not claim that a level's mean normal reflects as its children do.

float filter_level(float footprint) {
    return clamp(log2(max(footprint / voxel_size, 1e-3)) + filter_bias, 0.0, 5.0);
}
