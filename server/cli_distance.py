"""The command distance: one stand from near and from far against the reference, and on the way."""

from __future__ import annotations

import argparse
import dataclasses
import json
import math
import time
from pathlib import Path
from typing import Any, get_args

from renderer.core.channel import Progress
from renderer.core.errors import InputError, LimitError
from renderer.session import Session
from server.cli_draw import state_of, state_options
from server.cli_progress import Bar

LARGEST = 256
"""Side of a window, px: a reference of it takes minutes."""


def add(commands: Any) -> None:
    """Declare the command."""
    command = commands.add_parser("distance", help="brightness of one stand from near and from far, against the truth")
    state_options(command)
    command.add_argument("--distances", metavar="M,..", default="", help="metres (default: 2 m to 10 km)")
    command.add_argument(
        "--dolly", action="store_true", help="what pops and shimmers while the camera steps back at each distance"
    )
    command.add_argument("--size", type=int, default=48, help="pixels a side of each view (default %(default)s)")
    command.add_argument(
        "--judge",
        default="combination",
        help="combination: against the full reference; matter: without shadows on both sides (default %(default)s)",
    )
    command.add_argument("-o", "--output", metavar="FILE", type=Path, help="also write the numbers as JSON")
    command.set_defaults(run=run)


def run(given: argparse.Namespace) -> int:
    """Measure and print a table."""
    from renderer import distances
    from renderer.truth import Judge

    if given.judge not in get_args(Judge):
        raise InputError("--judge", f"{given.judge} is not known", ", ".join(get_args(Judge)))
    if not 8 <= given.size <= LARGEST:
        raise LimitError("--size", f"{given.size} is too small or too large", f"8 to {LARGEST} px")
    measure, table, every = (
        (distances.dolly, distances.stretches, distances.STRETCHES)
        if given.dolly
        else (distances.measure, distances.table, distances.DISTANCES)
    )
    chosen = _metres(given.distances) or every
    bar, begun = Bar(), time.monotonic()

    def tell(share: float, words: str) -> None:
        spent = time.monotonic() - begun
        bar(Progress("distance", share, words, spent / share * (1 - share) if share > 0.02 else 0.0))

    with Session() as session:
        state = state_of(session, given)
        try:
            lines: Any = measure(session, state, chosen, given.size, given.judge, tell)
        finally:
            bar.close()
    if given.output is not None:
        found = {
            "judge": given.judge,
            "size": given.size,
            "state": state.model_dump(mode="json"),
            "lines": [dataclasses.asdict(line) for line in lines],
        }
        given.output.write_text(json.dumps(found, indent=1), encoding="utf-8")
    print(table(lines))
    return 0


def _metres(text: str) -> tuple[float, ...]:
    try:
        metres = tuple(float(word) for word in text.split(",") if word)
    except ValueError:
        raise InputError("--distances", f"{text} are no numbers", "metres, separated by commas") from None
    if any(not (math.isfinite(one) and 0.1 <= one <= 30000) for one in metres):
        raise InputError("--distances", f"{text} are no distances", "0.1 to 30000 m")
    return metres
