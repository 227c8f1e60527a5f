"""The command keyframes: what interpolated key frames of shells err by."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from renderer.core.errors import InputError
from renderer.session import Session
from server.cli_study import DOCS, Teller, keep
from server.settings import load


def add(commands: Any) -> None:
    """Declare the command."""
    command = commands.add_parser("keyframes", help="interpolated key frames of shells: their error and their cost")
    command.add_argument("--size", type=int, default=160, help="side of the pictures, px (default %(default)s)")
    command.add_argument("--docs", action="store_true", help="copy table and charts into docs/study")
    command.set_defaults(run=run)


def run(given: argparse.Namespace) -> int:
    """Measure, and leave raw numbers, table and charts."""
    from renderer import key_study

    if not 16 <= given.size <= 512:
        raise InputError("--size", f"{given.size} is not studied", "16 to 512 px")
    folder = Path(load().study) / "shells" / "keyframes"
    tell = Teller("keyframes")
    try:
        with Session() as session:
            text = key_study.write(key_study.measure(session, given.size, tell), folder)
    finally:
        tell.bar.close()
    if given.docs:
        keep(folder, DOCS / "study" / "shells" / "keyframes", key_study.FILES)
    print(text)
    return 0
