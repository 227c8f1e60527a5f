"""The command climb: from a valley to space in one move, as a sheet of pictures, and what leaps on the way."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from renderer.core.errors import InputError
from renderer.session import Session
from server.cli_study import DOCS, Teller, keep
from server.settings import load

FRAMES, FEWEST, MOST = 24, 2, 240
KEPT = ("climb.jpg", "climb.md")
"""Files that the documentation keeps."""


def add(commands: Any) -> None:
    """Declare the command."""
    command = commands.add_parser(
        "climb", help="pictures from 2 m over a valley to 20,000 km, and what leaps on the way"
    )
    command.add_argument("scene", metavar="SCENE", choices=["clouds"])
    command.add_argument(
        "--preset", metavar="NAME", default="valley", help="whose sun, land and clouds (default %(default)s)"
    )
    command.add_argument("--frames", type=int, default=FRAMES, help="pictures of the sheet (default %(default)s)")
    command.add_argument("--docs", action="store_true", help="copy the sheet and the table into docs/study")
    command.set_defaults(run=run)


def run(given: argparse.Namespace) -> int:
    """Draw the sheet and step over the seams."""
    from renderer import climbing

    if not FEWEST <= given.frames <= MOST:
        raise InputError("--frames", f"{given.frames} are too few or too many", f"{FEWEST} to {MOST}")
    folder = Path(load().study) / given.scene / "climb"
    folder.mkdir(parents=True, exist_ok=True)
    tell = Teller("climb")
    with Session() as session:
        document = session.state(given.scene, given.preset).model_dump(mode="json")
        try:
            session.prepare(session.validate(document), tell.bar).future.result()
            climbing.climb(session, document, given.frames, tell).save(folder / KEPT[0], quality=82)
            text = climbing.table(climbing.seams(session, document, tell))
        finally:
            tell.bar.close()
    (folder / KEPT[1]).write_text(text, encoding="utf-8")
    if given.docs:
        keep(folder, DOCS / "study" / given.scene / "climb", KEPT)
    print(text, end="")
    return 0
