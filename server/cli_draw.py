"""Commands about scenes: scenes, describe, render, bake."""

from __future__ import annotations

import argparse
import json
import os
import re
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from renderer.core.errors import InputError, LimitError
from renderer.session import Session
from server.cli_asset import kept_files
from server.cli_progress import Bar
from server.settings import Settings, load

FORMATS = {".png": "png", ".jpg": "jpeg", ".jpeg": "jpeg", ".exr": "exr", ".npy": "npy"}
SIZE = re.compile(r"(\d{1,6})x(\d{1,6})")


def add(commands: Any) -> None:
    """Declare the commands."""
    listing = commands.add_parser("scenes", help="list scenes and their presets")
    listing.set_defaults(run=scenes)
    describing = commands.add_parser("describe", help="parameters and techniques of a scene")
    describing.add_argument("scene", metavar="SCENE")
    describing.add_argument("--json", action="store_true", help="the whole description, with the schema")
    describing.set_defaults(run=describe)
    rendering = commands.add_parser("render", help="draw a picture")
    state_options(rendering)
    rendering.add_argument("--size", metavar="WxH", default="512x512", help="pixels (default %(default)s)")
    rendering.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        type=Path,
        required=True,
        help=f"{' '.join(FORMATS)}; .exr and .npy hold linear radiance",
    )
    rendering.set_defaults(run=render)
    baking = commands.add_parser("bake", help="precompute what a state needs")
    state_options(baking)
    baking.set_defaults(run=bake)


def state_options(command: argparse.ArgumentParser, required: bool = True) -> None:
    """Declare what names a state; `required` where the command does nothing without one."""
    command.add_argument("scene", metavar="SCENE", nargs=None if required else "?")
    command.add_argument("--preset", metavar="NAME")
    command.add_argument("--combination", metavar="NAME", help="techniques of every slot by one name")
    command.add_argument("--state", metavar="FILE", help="a state document (JSON); - for standard input")
    command.add_argument(
        "--set",
        metavar="PATH=VALUE",
        action="append",
        default=[],
        dest="sets",
        help="one parameter, as sun.elevation=12 or terrain.asset=hill.npz; may be repeated",
    )


def scenes(given: argparse.Namespace) -> int:
    """List scenes and presets."""
    with Session() as session:
        for scene in session.scenes():
            print(f"{scene['name']:14} {scene['title']}: {scene['help']}")
            for preset in scene["presets"]:
                print(f"  --preset {preset['name']:20} {preset['title']}: {preset['help']}")
            for entry in scene["combinations"]:
                print(f"  --combination {entry['name']:15} {entry['title']}: {entry['help']}")
    return 0


def describe(given: argparse.Namespace) -> int:
    """Show a scene's techniques and parameters."""
    with Session() as session:
        found = session.describe(given.scene)
    if given.json:
        json.dump(found, sys.stdout, indent=1)
        print()
        return 0
    print(f"{found['name']}: {found['title']}\n{found['help']}\n")
    for slot in found["slots"]:
        print(f"{slot['name']}.kind  {slot['help']}")
        for technique in slot["techniques"]:
            mark = "*" if technique["kind"] == slot["default"] else " "
            why = "" if technique["available"] else f" ({technique['why_not']})"
            print(f"  {mark} {technique['kind']:24} {technique['caption']} {technique['paper']}{why}")
    print()
    for path, line in parameters(found["schema"]):
        print(f"{path:44} {line}")
    return 0


def parameters(schema: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Every parameter of a state's schema: its dotted path, and its default, range, unit and help in one line."""
    yield from _walk(schema, schema.get("$defs", {}), "")


def _walk(schema: dict[str, Any], known: dict[str, Any], prefix: str) -> Iterator[tuple[str, str]]:
    for name, declared in schema.get("properties", {}).items():
        options = [_resolve(option, known) for option in declared.get("oneOf", declared.get("anyOf", [declared]))]
        models = [option for option in options if "properties" in option]
        path = f"{prefix}{name}"
        for model in models:
            kind = model["properties"].get("kind", {}).get("const")
            yield from _walk(model, known, f"{path}[{kind}]." if kind and len(models) > 1 else f"{path}.")
        if not models and name != "kind":
            yield path, _line(declared)


def _resolve(option: dict[str, Any], known: dict[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = known.get(str(option.get("$ref", "")).rsplit("/", 1)[-1], option)
    return found


def _line(declared: dict[str, Any]) -> str:
    unit = declared.get("umbrage", {}).get("unit", "")
    low, high = (
        declared.get(key, declared.get(other))
        for key, other in (("minimum", "exclusiveMinimum"), ("maximum", "exclusiveMaximum"))
    )
    bounds = f" in [{low:g}, {high:g}]" if low is not None and high is not None else ""
    choices = f" of {', '.join(map(str, declared['enum']))}" if "enum" in declared else ""
    return (
        f"{json.dumps(declared.get('default'))}{bounds}{choices} {unit}".rstrip()
        + f"  {declared.get('description', '')}"
    )


def state_of(session: Session, given: argparse.Namespace) -> Any:
    """The state that the options describe.

    Raises:
        InputError, InvalidDocument: naming the field.
    """
    sets = {}
    for entry in given.sets:
        path, equals, text = entry.partition("=")
        if not equals:
            raise InputError("--set", f"{entry} has no value", "PATH=VALUE")
        sets[path] = value_of(text)
    if sets:
        sets = kept_files(sets, session.describe(given.scene)["schema"], session.assets)
    document = document_of(given.state) if given.state else None
    return session.state(given.scene, given.preset, sets, document, given.combination)


def value_of(text: str) -> Any:
    """A value on the command line: JSON where it is that, text otherwise."""
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return text


def document_of(name: str) -> dict[str, Any]:
    """A state document from a file, or from standard input for `-`.

    Raises:
        InputError: it is no JSON object.
    """
    try:
        found = json.loads(sys.stdin.read() if name == "-" else Path(name).read_text(encoding="utf-8"))
    except (ValueError, RecursionError):
        raise InputError("--state", f"{name} is not JSON") from None
    if not isinstance(found, dict):
        raise InputError("--state", f"{name} holds no JSON object")
    return found


def size_of(text: str, settings: Settings) -> tuple[int, int]:
    """Width and height of a picture [px].

    Raises:
        InputError: not two numbers.
        LimitError: more than the settings allow.
    """
    match = SIZE.fullmatch(text)
    if match is None:
        raise InputError("--size", f"{text} is no size", "WxH, as 512x512")
    width, height = int(match[1]), int(match[2])
    side, pixels = settings.max_side, settings.max_pixels
    if not (1 <= width <= side and 1 <= height <= side and width * height <= pixels):
        raise LimitError(
            "--size",
            f"{text} is too small or too large",
            f"1 to {side} px a side, {pixels} px in all (UMBRAGE_MAX_SIDE, UMBRAGE_MAX_PIXELS)",
        )
    return width, height


def render(given: argparse.Namespace) -> int:
    """Draw a picture into a file."""
    output: Path = given.output
    if output.suffix.lower() not in FORMATS:
        raise InputError("--output", f"{output.name} ends in no format that is written", " ".join(FORMATS))
    if not output.parent.is_dir():
        raise InputError("--output", f"there is no folder {output.parent}")
    width, height = size_of(given.size, load())
    bar = Bar()
    with Session() as session:
        state = state_of(session, given)
        try:
            picture = session.render(state, width, height, bar)
        finally:
            bar.close()
        data = picture.encode(FORMATS[output.suffix.lower()])
    write(output, data)
    print(f"{output}: {width} x {height}, {picture.samples} samples a pixel, {picture.render_ms:.0f} ms")
    return 0


def write(path: Path, data: bytes) -> None:
    """Replace a file at once: a reader never sees half of it."""
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        umask = os.umask(0)
        os.umask(umask)
        Path(name).chmod(0o666 & ~umask)
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def bake(given: argparse.Namespace) -> int:
    """Precompute what a state needs."""
    bar = Bar()
    with Session() as session:
        state = state_of(session, given)
        seconds = session.expected_seconds(state)
        print(
            f"{given.scene}: "
            + (f"about {seconds:.0f} s of precomputation" if seconds else "everything is in the cache")
        )
        preparation = session.prepare(state, bar)
        try:
            preparation.future.result()
        except KeyboardInterrupt:
            preparation.cancel()
            raise
        finally:
            bar.close()
    print(f"{given.scene}: ready")
    return 0
