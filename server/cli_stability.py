"""The command that measures how steady pictures are while something moves: stability."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from renderer.choices import choices_of, plain
from renderer.core.errors import InputError
from renderer.session import Session
from server.cli_study import DOCS, Teller, keep, names_of
from server.settings import load

KEPT = ("table.md", "flicker.png", "flicker.svg")
"""Files that the documentation keeps."""


def add(commands: Any) -> None:
    """Declare the command."""
    command = commands.add_parser("stability", help="flicker of techniques while the sun, the camera or a number moves")
    command.add_argument("scene", metavar="SCENE")
    command.add_argument("--presets", metavar="NAME,..", default="", help="all, or names (default: the scene's first)")
    command.add_argument(
        "--sweep",
        metavar="NAME,..",
        default="sun_azimuth,camera",
        help="sun_azimuth, sun_elevation, camera, or the path of a number (default %(default)s)",
    )
    command.add_argument("--slot", default="shadow", help="slot whose techniques are compared (default %(default)s)")
    command.add_argument(
        "--techniques", metavar="KIND[:NAME=VALUE..],..", default="", help="with parameters (default: all, as they are)"
    )
    command.add_argument("--set", metavar="PATH=VALUE", action="append", default=[], help="change the preset")
    command.add_argument("--width", type=int, default=128, help="of the pictures, px (default %(default)s, as stated)")
    command.add_argument("--steps", type=int, default=16, help="of each sweep (default %(default)s, as stated)")
    command.add_argument("--docs", action="store_true", help="copy table and chart into docs/stability")
    command.set_defaults(run=stability)


def stability(given: argparse.Namespace) -> int:
    """Measure sweeps and write their raw results, table, chart and worst frames."""
    from renderer import steadying  # charts take a second to import, which no other command should pay

    with Session() as session:
        scene = session.describe(given.scene)
        every = tuple(scene["presets"])
        slots = tuple(slot["name"] for slot in scene["slots"])
        if given.slot not in slots:
            raise InputError("--slot", f"{given.slot} is not known", ", ".join(slots))
        sets = dict(pair_of(text) for text in given.set)
        choices = choices_of(given.scene, given.slot, given.techniques)
        plans = [
            steadying.Plan(given.scene, preset, sweep, given.slot, choices, sets, given.width, given.steps).checked()
            for preset in names_of("--presets", given.presets, every) or every[:1]
            for sweep in given.sweep.split(",")
        ]
        folder = Path(load().study) / "stability" / given.scene
        tell = Teller(given.scene)
        try:
            steadying.run(session, plans, folder, tell)
        finally:
            tell.bar.close()
    if given.docs:
        keep(folder, DOCS / "stability" / given.scene, KEPT)
    print((folder / "table.md").read_text(encoding="utf-8"), end="")
    print(f"{folder}: results.jsonl, table.md, flicker.png .svg; worst/ holds the frames of each worst step")
    return 0


def pair_of(text: str) -> tuple[str, Any]:
    """A path and its value from `PATH=VALUE`.

    Raises:
        InputError: there is no equals sign.
    """
    path, sign, value = text.partition("=")
    if not sign or not path:
        raise InputError("--set", f"{text} is not understood", "PATH=VALUE")
    return path, plain(value)
