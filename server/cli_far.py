"""The command far: shells from near and from far, filtered, against the reference, and while the camera steps back."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from renderer.core.errors import InputError
from renderer.session import Session
from server.cli_stability import KEPT
from server.cli_study import DOCS, Teller, keep, presets_of
from server.settings import load


def add(commands: Any) -> None:
    """Declare the command."""
    command = commands.add_parser("far", help="brightness and opacity of filtered shells from five distances")
    command.add_argument("--presets", metavar="NAME,..", default="", help="all, or names (default: three of them)")
    command.add_argument(
        "--techniques", metavar="KIND[:NAME=VALUE..],..", default="", help="filters, with parameters"
    )
    command.add_argument("--times", metavar="N,..", default="", help="how many times as far (default 2,4,8,12,16)")
    command.add_argument("--steady", action="store_true", help="flicker while the camera steps back, instead")
    command.add_argument("--docs", action="store_true", help="copy table and chart into docs/study")
    command.set_defaults(run=run)


def run(given: argparse.Namespace) -> int:
    """Measure, and leave raw numbers, a table and a chart."""
    from renderer import far_study, steadying  # charts take a second to import, which no other command should pay
    from renderer.benching import provenance

    times = times_of(given.times) or far_study.TIMES
    techniques = given.techniques or far_study.TECHNIQUES
    folder = Path(load().study) / "shells" / ("dolly" if given.steady else "distance")
    tell = Teller("far")
    with Session() as session:
        try:
            every = session.describe("shells")["presets"]
            presets = presets_of(given.presets, every) if given.presets else far_study.PRESETS
            if given.steady:
                steadying.run(session, far_study.sweeps(session, presets, techniques), folder, tell)
                text = (folder / "table.md").read_text(encoding="utf-8")
            else:
                lines = far_study.measure(session, presets, techniques, times, tell)
                machine = provenance(session.gl.info.renderer)["renderer"]
                text = far_study.write(lines, folder, f"shells from near and from far, {machine}")
        finally:
            tell.bar.close()
    if given.docs:
        keep(folder, DOCS / "study" / "shells" / folder.name, KEPT if given.steady else far_study.FILES)
    print(text)
    return 0


def times_of(text: str) -> tuple[float, ...]:
    """Numbers from text.

    Raises:
        InputError: naming the option.
    """
    try:
        times = tuple(float(word) for word in text.split(",") if word)
    except ValueError:
        raise InputError("--times", f"{text} are no numbers", "numbers, separated by commas") from None
    if any(not 0.25 <= one <= 64 for one in times):
        raise InputError("--times", f"{text} is too near or too far", "0.25 to 64")
    return times
