"""Studies of the directional textures, parts of the command `study`."""

from __future__ import annotations

import argparse
from pathlib import Path

from renderer.core.errors import InputError
from server.cli_study import DOCS, Teller, keep
from server.settings import load


def memory(given: argparse.Namespace) -> int:
    """Measure bytes and bake times against texels and directions, and write raw results, table and chart."""
    from renderer import directional_memory

    if given.scene != "directional":
        raise InputError("--memory", f"{given.scene} has no such tables", "directional")
    folder = Path(load().study) / given.scene / "memory"
    tell = Teller("memory")
    try:
        print(directional_memory.run(folder, tell))
    finally:
        tell.bar.close()
    if given.docs:
        keep(folder, DOCS / "study" / given.scene / "memory", directional_memory.FILES)
    print(f"{folder}: {', '.join(directional_memory.FILES)}")
    return 0
