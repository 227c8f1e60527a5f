"""The command `measure`: physical quantities into a file or onto the terminal."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from renderer.core.errors import InputError
from renderer.session import Session
from server.cli_draw import value_of


def add(commands: Any, wanted: bool) -> None:
    """Declare the command and, where it is wanted, the options of each quantity from its declared arguments."""
    command = commands.add_parser("measure", help="a physical quantity, as horizon or sun")
    if not wanted:
        return
    quantities = command.add_subparsers(dest="quantity", required=True, metavar="QUANTITY")
    for found in Session.quantities():
        _quantity(quantities, found)


def _quantity(quantities: Any, found: Mapping[str, Any]) -> None:
    command = quantities.add_parser(found["name"], help=found["help"], description=found["help"])
    properties = found["schema"].get("properties", {})
    files = {entry["name"]: entry for entry in found["files"]}
    for name in dict.fromkeys([*files, *properties]):
        declared = properties.get(name, {})
        words = [declared.get("description", ""), files[name]["help"] if name in files else ""]
        unit = declared.get("umbrage", {}).get("unit", "")
        default = (
            f"(default {json.dumps(declared['default'])}{' ' + unit if unit else ''})" if "default" in declared else ""
        )
        command.add_argument(
            f"--{name.replace('_', '-')}",
            dest=f"argument_{name}",
            metavar="FILE" if name in files else "VALUE",
            help=" ".join(filter(None, [*words, default])).replace("%", "%%"),
        )
    command.add_argument(
        "-o", "--output", metavar="FILE", type=Path, help=".json or .npz; standard output when left out"
    )
    command.set_defaults(run=run, found=found)


def run(given: argparse.Namespace) -> int:
    """Measure, and write the result."""
    names = {entry["name"] for entry in given.found["files"]}
    declared = given.found["schema"].get("properties", {})
    arguments: dict[str, Any] = {}
    files: dict[str, Path] = {}
    for name in dict.fromkeys([*names, *declared]):
        text = getattr(given, f"argument_{name}")
        if text is None:
            continue
        # Points, say, are an argument or a file: JSON is the argument.
        value = value_of(text)
        if name in names and isinstance(value, str):
            files[name] = _existing(name, text)
        else:
            arguments[name] = text if declared.get(name, {}).get("type") == "string" else value
    measured = Session.measure(given.quantity, arguments, files)
    if given.output is None:
        json.dump(measured.as_json(), sys.stdout, indent=1, allow_nan=False)
        print()
    else:
        measured.save(given.output)
        print(f"{given.output}: {', '.join(measured.arrays)}")
    return 0


def _existing(name: str, text: str) -> Path:
    path = Path(text)
    if not path.is_file():
        raise InputError(name, f"there is no file {text}")
    return path
