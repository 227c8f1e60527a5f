"""The command orders: every order of shells against the exact one."""

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
    command = commands.add_parser("orders", help="every order of shells' cells: wrong pixels, and what sorting takes")
    command.add_argument("--presets", metavar="NAME,..", default="all", help="all, or names (default %(default)s)")
    command.add_argument("--size", type=int, default=192, help="side of the pictures, px (default %(default)s)")
    command.add_argument("--docs", action="store_true", help="copy table and charts into docs/study")
    command.set_defaults(run=run)


def run(given: argparse.Namespace) -> int:
    """Measure, and leave raw numbers, table and charts."""
    from renderer import order_study

    if not 16 <= given.size <= 512:
        raise InputError("--size", f"{given.size} is not studied", "16 to 512 px")
    presets = names_of("--presets", given.presets, order_study.presets_of())
    folder = Path(load().study) / "shells" / "orders"
    tell = Teller("orders")
    try:
        with Session() as session:
            text = order_study.write(order_study.measure(session, presets, given.size, tell), folder)
    finally:
        tell.bar.close()
    if given.docs:
        keep(folder, DOCS / "study" / "shells" / "orders", order_study.FILES)
    print(text)
    return 0
