"""Commands about leaves: the fits of their lobes, and what every way of filtering them loses from level to level."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from renderer.session import Session
from server.cli_study import DOCS, Teller, keep
from server.settings import load

KEPT = ("levels.md", "levels.svg", "levels.png")
"""Files that the documentation keeps."""


def add(commands: Any) -> None:
    """Declare the commands."""
    command = commands.add_parser("leaves", help="fit lobes to leaves, or compare how their coarser levels are made")
    chosen = command.add_subparsers(dest="what", required=True, metavar="WHAT")
    fit = chosen.add_parser("fit", help="fit lobes anew, and hold them to leaves of three species (needs prosail)")
    fit.set_defaults(run=fits)
    level = chosen.add_parser("levels", help="error of averaged, refitted and modern levels against all their voxels")
    level.add_argument("--docs", action="store_true", help="copy table and chart into docs/study")
    level.set_defaults(run=levels)


def fits(given: argparse.Namespace) -> int:
    """Write the fits and say their residuals."""
    from renderer import leaf_study  # charts take a second to import, which no other command should pay

    for name, one in leaf_study.write_fits()["species"].items():
        print(name, *(f"{kind} {value:.3f}" for kind, value in one["residuals"].items()))
    return 0


def levels(given: argparse.Namespace) -> int:
    """Measure every level; leave raw numbers, a table and a chart."""
    from renderer import leaf_study

    folder = Path(load().study) / "forest" / "leaves"
    tell = Teller("levels")
    with Session() as session:
        try:
            text = leaf_study.run_levels(session, folder, tell)
        finally:
            tell.bar.close()
    if given.docs:
        keep(folder, DOCS / "study" / "forest" / "leaves", KEPT)
    print(text)
    return 0
