"""Files of one's own on the command line: the command asset, and file names in the place of `asset:HASH`."""

from __future__ import annotations

import argparse
import json
import re
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from renderer.core.cache import AssetStore
from renderer.core.errors import InputError
from renderer.session import Session

IS_ASSET = re.compile(r"asset:[0-9a-f]{64}")


def add(commands: Any) -> None:
    """Declare the command."""
    storing = commands.add_parser("asset", help="check a file of one's own and keep it, or list what is kept")
    storing.add_argument("file", metavar="FILE", type=Path, nargs="?", help="without it, what is kept is listed")
    storing.add_argument(
        "--reading",
        metavar="FIELD=VALUE",
        action="append",
        default=[],
        help="what the file leaves unsaid, as cell_size=[10,10] or holes=fill; may be repeated",
    )
    storing.add_argument("--json", action="store_true", help="the whole answer; otherwise its asset:HASH comes last")
    storing.set_defaults(run=store)


def store(given: argparse.Namespace) -> int:
    """Check a file and keep it, or list what is kept."""
    if given.file is None:
        return _list(given.json)
    reading = dict(_pair(entry) for entry in given.reading)
    stored = keep(given.file, reading, AssetStore())
    if given.json:
        print(json.dumps(stored, indent=1))
        return 0
    print(f"{stored['name']}: {stored['kind']}, kept until {_date(stored['expires'])} or longer if it is used")
    for name, value in stored["preview"].items():
        if value not in (None, "", []):
            print(f"  {name.replace('_', ' ')}: {value if isinstance(value, str) else json.dumps(value)}")
    print(stored["asset"])
    return 0


def _list(whole: bool) -> int:
    entries = [{"asset": f"asset:{entry.pop('hash')}", **entry} for entry in AssetStore().list()]
    if whole:
        print(json.dumps(entries, indent=1))
        return 0
    for entry in entries:
        what = f"{entry['kind']:8} {entry['bytes']:>12,} bytes  until {_date(entry['expires'])}  {entry['name']}"
        print(f"{entry['asset']}  {what}")
    return 0


def _date(moment: float) -> str:
    return time.strftime("%Y-%m-%d", time.localtime(moment))


def _pair(entry: str) -> tuple[str, Any]:
    name, equals, text = entry.partition("=")
    if not equals:
        raise InputError("--reading", f"{entry} has no value", "FIELD=VALUE")
    return name, _value(text)


def _value(text: str) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return text


def keep(file: Path, reading: Mapping[str, Any], assets: AssetStore) -> dict[str, Any]:
    """Check a file in a process of its own and keep it; as `Session.add_asset`.

    Raises:
        InputError: there is no such file, or what is wrong with it.
    """
    if not file.is_file():
        raise InputError("FILE", f"there is no file {file}")
    return Session.admit(assets, file, file.name, reading)


def asset_fields(schema: Any) -> set[str]:
    """Names of the fields of a state's schema that take an uploaded file, or a list of them."""
    found = set()
    for name, declared in _properties(schema):
        patterns = [declared.get("pattern", ""), declared.get("items", {}).get("pattern", "")]
        if any("asset:" in pattern for pattern in patterns):
            found.add(name)
    return found


def _properties(schema: Any) -> Iterator[tuple[str, dict[str, Any]]]:
    if isinstance(schema, dict):
        yield from schema.get("properties", {}).items()
        for value in schema.values():
            yield from _properties(value)
    elif isinstance(schema, list):
        for value in schema:
            yield from _properties(value)


def kept_files(sets: Mapping[str, Any], schema: Any, assets: AssetStore) -> dict[str, Any]:
    """Single values of a state, with file names in the place of assets checked, kept and replaced by their assets.

    Args:
        sets: by dotted path. schema: of the state. assets: where files are kept.

    Raises:
        InputError: naming the path, for a file that is missing or cannot serve.
    """
    fields = asset_fields(schema)
    return {
        path: _kept(path, value, sets, assets) if path.rsplit(".", 1)[-1] in fields else value
        for path, value in sets.items()
    }


def _kept(path: str, value: Any, sets: Mapping[str, Any], assets: AssetStore) -> Any:
    if isinstance(value, list):
        return [_kept(path, one, sets, assets) for one in value]
    if not isinstance(value, str) or not value or IS_ASSET.fullmatch(value):
        return value
    file = Path(value).expanduser()
    if " " in value and not file.is_file():
        return " ".join(_kept(path, one, sets, assets) for one in value.split())
    if not file.is_file():
        raise InputError(path, f"{value} is neither a file nor an asset", "the name of a file, or asset:HASH")
    parent, _, name = path.rpartition(".")
    # What is said about a file in the same call must be known when it is checked.
    starts = (f"{parent}.reading.", f"{parent}.{name.split('_')[0]}_reading.")
    reading = {other.rsplit(".", 1)[-1]: said for other, said in sets.items() if other.startswith(starts)}
    try:
        return keep(file, reading, assets)["asset"]
    except InputError as failure:
        raise failure.at(path) from None
