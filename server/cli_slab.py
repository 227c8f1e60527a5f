"""The study of light within a plane cloud, a part of the command `study`."""

from __future__ import annotations

import argparse
from pathlib import Path

from renderer.core.errors import InputError
from server.cli_study import DOCS, Teller, keep
from server.settings import load


def study(given: argparse.Namespace) -> int:
    """Hold every scattering technique to photons in a plane cloud, and write raw results, table and charts."""
    from renderer import slab_report

    if given.scene != "clouds":
        raise InputError("--slab", f"{given.scene} has no clouds", "clouds")
    if not 1000 <= given.photons <= 100_000_000:
        raise InputError("--photons", "too few or too many", "1,000 to 100,000,000")
    folder = Path(load().study) / given.scene / "slab"
    tell = Teller("slab")
    try:
        print(slab_report.run(folder, given.photons, tell))
    finally:
        tell.bar.close()
    if given.docs:
        keep(folder, DOCS / "study" / given.scene / "slab", slab_report.FILES)
    print(f"{folder}: {', '.join(slab_report.FILES)}")
    return 0
