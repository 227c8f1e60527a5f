"""Studies of the directional textures, parts of the command `study`."""

from __future__ import annotations

import argparse
from pathlib import Path

from renderer.core.errors import InputError
from renderer.session import Session
from server.cli_study import DOCS, Teller, keep, names_of, presets_of
from server.settings import load


def memory(given: argparse.Namespace) -> int:
    """Measure bytes and bake times against texels and directions, and write raw results, table and chart."""
    from renderer import directional_memory

    if given.scene != "directional":
        raise InputError("--memory", f"{given.scene} has no such tables", "directional")
    folder = Path(load().study) / given.scene / "memory"
    tell = Teller("memory")
    try:
        print(directional_memory.run(folder, tell))
    finally:
        tell.bar.close()
    if given.docs:
        keep(folder, DOCS / "study" / given.scene / "memory", directional_memory.FILES)
    print(f"{folder}: {', '.join(directional_memory.FILES)}")
    return 0


def faces(given: argparse.Namespace) -> int:
    """Hold texels, directions, selections and codes to the reference, and write raw results, table and charts."""
    from renderer import directional_report as report
    from renderer import directional_study

    scene = directional_study.SCENE
    if given.scene != scene:
        raise InputError("--faces", f"{given.scene} has no faces that see points", scene)
    suns = int(given.suns) if given.suns.isdigit() else directional_study.SUNS_USED
    if not 1 <= given.views <= directional_study.VIEWS or not 1 <= suns <= directional_study.SUNS_USED:
        most = f"{directional_study.VIEWS} views and {directional_study.SUNS_USED} suns"
        raise InputError("--views", "or --suns is out of its range", f"at most {most}")
    parts = names_of("--slots", given.slots or "all", tuple(report.PARTS))
    folder = Path(load().study) / scene / "faces"
    tell = Teller(scene)
    with Session() as session:
        presets = presets_of(given.presets or "1", session.describe(scene)["presets"])
        try:
            print(report.run(session, presets, folder, given.views, suns, parts, tell))
        finally:
            tell.bar.close()
    if given.docs:
        keep(folder, DOCS / "study" / scene / "faces", report.FILES)
    print(f"{folder}: results.jsonl, {', '.join(report.FILES)}")
    return 0
