"""The command `sunstudy`: maps of the sun's hours and energy over a land."""

from __future__ import annotations

import argparse
import io
import json
from pathlib import Path
from typing import Any

import numpy as np

from renderer.core.errors import InputError
from renderer.session import Session
from server.cli_draw import state_of, state_options, value_of, write
from server.cli_progress import Bar
from server.sun_maps import MAPS, map_files

FILES = ("terrain", "canopy")


def add(commands: Any, wanted: bool) -> None:
    """Declare the command and, where it is wanted, an option for each declared argument of a study."""
    command = commands.add_parser(
        "sunstudy", help="maps of hours of sun and of insolation over a land, for a range of days"
    )
    if not wanted:
        return
    state_options(command, required=False)
    command.add_argument("--terrain", metavar="FILE", type=Path, help="a land of your own, in place of a scene's")
    command.add_argument("--canopy", metavar="FILE", type=Path, help="heights of trees on the terrain's nodes, m")
    declared = arguments()
    for name, field in declared.items():
        unit = field.get("umbrage", {}).get("unit", "")
        default = "" if field.get("default") is None else f" (default {field['default']}{' ' + unit if unit else ''})"
        choices = f" One of {', '.join(field['enum'])}." if "enum" in field else ""
        words = field.get("description", "") + choices + default
        command.add_argument(
            f"--{name.replace('_', '-')}", dest=f"argument_{name}", metavar="VALUE", help=words.replace("%", "%%")
        )
    command.add_argument(
        "-o", "--output", metavar="FOLDER", type=Path, required=True, help="gets GeoTIFFs, pictures, .npz and .json"
    )
    command.set_defaults(run=run, declared=declared)


def arguments() -> dict[str, Any]:
    """The schema of each argument of a study."""
    (found,) = (quantity for quantity in Session.quantities() if quantity["name"] == "sunlight")
    return {name: field for name, field in found["schema"]["properties"].items() if name != "points"}


def run(given: argparse.Namespace) -> int:
    """Study a land, and write its maps; what was stopped goes on when it is asked for again."""
    if given.output.exists() and not given.output.is_dir():
        raise InputError("--output", f"{given.output} is no folder")
    files = {name: _existing(name, getattr(given, name)) for name in FILES if getattr(given, name) is not None}
    if files and given.scene:
        raise InputError("--terrain", "is given beside a scene, which has its own", "one of the two")
    period = {}
    for name, field in given.declared.items():
        text = getattr(given, f"argument_{name}")
        if text is not None:
            period[name] = text if field.get("type") == "string" else value_of(text)
    bar = Bar()
    with Session() as session:
        state = state_of(session, given) if given.scene else None
        try:
            found = session.sunlight(period, state, files, bar)
        finally:
            bar.close()
    given.output.mkdir(parents=True, exist_ok=True)
    for name, data in files_of(found).items():
        write(given.output / name, data)
    numbers = found.numbers
    for name in MAPS:
        told = numbers[name]
        print(f"{name}: {told['lowest']:.0f} to {told['highest']:.0f} {told['unit']}, mean {told['mean']:.0f}")
    print(f"{given.output}: {', '.join(files_of(found))}")
    return 0


def files_of(found: Any) -> dict[str, bytes]:
    """What a study leaves, by file name: its maps, all arrays, and the numbers."""
    buffer = io.BytesIO()
    np.savez(buffer, meta=np.array(json.dumps(dict(found.meta))), **found.arrays)
    numbers = json.dumps(found.numbers, indent=1).encode()
    return {**map_files(found), "sunlight.npz": buffer.getvalue(), "sunlight.json": numbers}


def _existing(name: str, path: Path) -> Path:
    if not path.is_file():
        raise InputError(f"--{name}", f"there is no file {path}")
    return path
