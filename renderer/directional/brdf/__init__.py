"""Tabulated reflectances: where they come from, how they are read, and what the GPU holds of them."""
