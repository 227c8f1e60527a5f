"""The study of light between ground and clouds, a part of the command `study`."""

from __future__ import annotations

import argparse
from pathlib import Path

from renderer.core.errors import InputError
from server.cli_study import DOCS, Teller, keep
from server.settings import load

FEWEST, MOST = 64, 65_536
"""Rays of each point of the truth."""


def study(given: argparse.Namespace) -> int:
    """Hold every technique of bounced light to form factors by rays, and write raw results, tables and charts."""
    from renderer import radiosity_report

    if given.scene != "clouds":
        raise InputError("--radiosity", f"{given.scene} has no clouds", "clouds")
    if not FEWEST <= given.rays <= MOST or given.rays & (given.rays - 1):
        raise InputError("--rays", "is no power of two in the range", f"{FEWEST} to {MOST:,}")
    folder = Path(load().study) / given.scene / "radiosity"
    tell = Teller("radiosity")
    try:
        print(radiosity_report.run(folder, given.rays, tell))
    finally:
        tell.bar.close()
    if given.docs:
        keep(folder, DOCS / "study" / given.scene / "radiosity", radiosity_report.FILES)
    print(f"{folder}: {', '.join(radiosity_report.FILES)}")
    return 0
