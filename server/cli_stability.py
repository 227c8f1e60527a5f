"""Commands that measure techniques one by one: stability, the catalogue of failures, the facts that the page tells."""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from renderer.choices import choices_of, plain
from renderer.core.errors import InputError
from renderer.session import Session
from server.cli_study import DOCS, Teller, keep, names_of, presets_of
from server.settings import load

KEPT = ("results.jsonl", "table.md", "flicker.png", "flicker.svg")
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
    command.add_argument("--docs", action="store_true", help="copy table and chart into docs/study")
    command.set_defaults(run=stability)
    command = commands.add_parser("facts", help="cost and error of every technique alone, as the page tells them")
    command.add_argument("scene", metavar="SCENE")
    command.add_argument("--presets", metavar="NAME,..", default="all", help="all, or names (default %(default)s)")
    command.add_argument("--size", type=int, default=128, help="side of the pictures, px (default %(default)s)")
    command.add_argument("--frames", type=int, default=30, help="timed frames of each (default %(default)s)")
    command.add_argument("--docs", action="store_true", help="copy what was measured into docs/study")
    command.set_defaults(run=facts)
    command = commands.add_parser("failures", help="where techniques fail, why, and what survives there")
    command.add_argument("scene", metavar="SCENE")
    command.add_argument("--measure", metavar="NAME,..", default="", help="measure them today: all, or names")
    command.add_argument("--docs", action="store_true", help="copy what was measured into docs/study")
    command.add_argument("--json", action="store_true", help="as JSON")
    command.set_defaults(run=list_failures)


def facts(given: argparse.Namespace) -> int:
    """Measure what the page says below each technique's caption."""
    from renderer import technique_facts

    if given.frames < 1:
        raise InputError("--frames", "must be at least one", "9 for a first impression, 30 for stated medians")
    folder = Path(load().study) / given.scene / "techniques"
    tell = Teller(given.scene)
    try:
        with Session() as session:
            presets = presets_of(given.presets, session.describe(given.scene)["presets"])
            path = technique_facts.measure(session, given.scene, folder, given.size, given.frames, tell, presets)
    finally:
        tell.bar.close()
    if given.docs:
        keep(folder, DOCS / "study" / given.scene / "techniques", (path.name,))
    print(path)
    return 0


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
            for preset in presets_of(given.presets, scene["presets"]) or every[:1]
            for sweep in given.sweep.split(",")
        ]
        folder = Path(load().study) / given.scene / "stability"
        tell = Teller(given.scene)
        try:
            steadying.run(session, plans, folder, tell)
        finally:
            tell.bar.close()
    if given.docs:
        keep(folder, DOCS / "study" / given.scene / "stability", KEPT)
    print((folder / "table.md").read_text(encoding="utf-8"), end="")
    print(f"{folder}: results.jsonl, table.md, flicker.png .svg; worst/ holds the frames of each worst step")
    return 0


def list_failures(given: argparse.Namespace) -> int:
    """List the cases of a scene's catalogue; measured today, they go beside the study, which HTTP serves."""
    from renderer import failing
    from renderer.benching import provenance

    cases = failing.failures(given.scene)
    found = [failing.document(case) for case in cases.values()]
    if given.measure:
        folder = Path(load().study) / given.scene / "failures"
        wanted = names_of("--measure", given.measure, tuple(cases))
        tell = Teller(given.scene)
        try:
            with Session() as session:
                verdicts = [failing.judge(session, given.scene, name, tell) for name in wanted]
                machine = provenance(session.gl.info.renderer)
        finally:
            tell.bar.close()
        failing.keep(folder, verdicts, machine)
        found = [verdict.document() for verdict in verdicts]
        if given.docs:
            failing.keep(DOCS / "study" / given.scene / "failures", verdicts, machine)
    print(json.dumps(found, indent=1) if given.json else "\n\n".join(map(_told, found)))
    return 0 if all(one["holds"] is not False for one in found) else 1


def _told(case: Mapping[str, Any]) -> str:
    """A case as lines."""
    where = f"{case['preset']}{', ' + case['sweep'] + ' moving' if case['sweep'] else ''}: " if "preset" in case else ""
    today = [case["failing_now"], case["surviving_now"]]
    failing, surviving = today if case["holds"] is not None else case["measured"]
    verdict = {None: "", True: " (measured now)", False: " (measured now: the case no longer holds)"}[case["holds"]]
    return (
        f"{case['name']}: {case['title']}\n"
        f"  {where}{case['symptom']} above {case['threshold']:g} is a failure{verdict}\n"
        f"  {failing:.3g} {case['failing']}\n"
        f"  {surviving:.3g} {case['surviving']}\n"
        f"  {case['cause']}"
    )


def pair_of(text: str) -> tuple[str, Any]:
    """A path and its value from `PATH=VALUE`.

    Raises:
        InputError: there is no equals sign.
    """
    path, sign, value = text.partition("=")
    if not sign or not path:
        raise InputError("--set", f"{text} is not understood", "PATH=VALUE")
    return path, plain(value)
