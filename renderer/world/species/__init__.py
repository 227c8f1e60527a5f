"""The built-in species: one file each, found by walking this folder."""

from __future__ import annotations

import functools
import importlib
import pkgutil

from renderer.world.tree import Species


@functools.cache
def species() -> dict[str, Species]:
    """Every built-in species by name, which is also the name of its weight in the document's `canopy`."""
    names = sorted(module.name for module in pkgutil.iter_modules(__path__))
    return {name: importlib.import_module(f"{__name__}.{name}").SPECIES for name in names}
