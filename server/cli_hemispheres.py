"""The study of shadow hemispheres, a part of the command `study`."""

from __future__ import annotations

import argparse
from pathlib import Path

from renderer.core.errors import InputError
from server.settings import load

FEWEST, MOST = 1000, 2_000_000
"""Points of a cloud."""


POINTS = 30_000


def add(command: argparse.ArgumentParser) -> None:
    """Declare its options."""
    command.add_argument("--hemispheres", action="store_true", help="of codes of shadows instead (directional)")
    command.add_argument("--mesh", type=Path, help="whose points are one cloud more (with --hemispheres)")
    command.add_argument("--points", type=int, default=POINTS, help="of each cloud, about (with --hemispheres)")


def study(given: argparse.Namespace) -> int:
    """Hold every code of shadow hemispheres to the masks it was made of, and masks to rays; write tables and charts."""
    from renderer import hemisphere_report
    from server.cli_study import DOCS, Teller, keep

    if given.scene != "directional":
        raise InputError("--hemispheres", f"{given.scene} has no points", "directional")
    if not FEWEST <= given.points <= MOST:
        raise InputError("--points", "too few or too many", f"{FEWEST:,} to {MOST:,}")
    if given.mesh is not None and not given.mesh.is_file():
        raise InputError("--mesh", "there is no such file", "a mesh in any format that a scene takes")
    folder = Path(load().study) / given.scene / "hemispheres"
    tell = Teller("hemispheres")
    try:
        print(hemisphere_report.run(folder, given.mesh, given.points, tell))
    finally:
        tell.bar.close()
    if given.docs:
        keep(folder, DOCS / "study" / given.scene / "hemispheres", hemisphere_report.FILES)
    print(f"{folder}: {', '.join(hemisphere_report.FILES)}")
    return 0
