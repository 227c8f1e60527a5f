"""The command headline: the thesis' six scenes of shells, by default and with the thesis' own settings."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from renderer.core.errors import InputError
from renderer.session import Session
from server.cli_study import DOCS, Teller, keep, names_of
from server.settings import load


def add(commands: Any) -> None:
    """Declare the command."""
    command = commands.add_parser("headline", help="six scenes of shells: error and time beside the thesis' settings")
    command.add_argument("--presets", metavar="NAME,..", default="all", help="all, or names (default %(default)s)")
    command.add_argument("--size", type=int, default=48, help="side of what is judged, px (default %(default)s)")
    command.add_argument("--whole", type=int, default=128, help="of whole pictures, px, or 0 (default %(default)s)")
    command.add_argument("--frames", type=int, default=9, help="timed of each, 0 for no times (default %(default)s)")
    command.add_argument("--docs", action="store_true", help="copy the table into docs/study")
    command.set_defaults(run=run)


def run(given: argparse.Namespace) -> int:
    """Measure, and leave raw numbers and the table."""
    from renderer import headline_study

    if not 16 <= given.size <= 256:
        raise InputError("--size", f"{given.size} is not studied", "16 to 256 px")
    if given.whole and not 16 <= given.whole <= 256:
        raise InputError("--whole", f"{given.whole} is not studied", "16 to 256 px, or 0")
    if given.frames < 0:
        raise InputError("--frames", "cannot be negative", "0 for no times")
    presets = names_of("--presets", given.presets, tuple(headline_study.SAMPLES))
    folder = Path(load().study) / "shells" / "headline"
    tell = Teller("headline")
    try:
        with Session() as session:
            lines = headline_study.measure(session, presets, given.size, given.whole, given.frames, tell)
        text = headline_study.write(lines, folder)
    finally:
        tell.bar.close()
    if given.docs:
        keep(folder, DOCS / "study" / "shells" / "headline", headline_study.FILES)
    print(text)
    return 0
