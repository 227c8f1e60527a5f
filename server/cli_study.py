"""Commands that measure the techniques: study, bench."""

from __future__ import annotations

import argparse
import shutil
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from renderer.benching import COMBINATION
from renderer.core.channel import Progress
from renderer.core.errors import InputError
from renderer.session import Session
from server import cli_hemispheres
from server.cli_progress import Bar
from server.settings import ROOT, load

DOCS = ROOT / "docs"
OUT = ROOT / "out" / "bench"
KEPT = ("table.md", "speed_accuracy.svg", "speed_accuracy.png")
"""Files of a study that the documentation keeps."""

KINDS = "kinds"
"""Folder of the table of shadow kinds."""

FRAMES = 30
"""Timed frames of each technique."""

PHOTONS = 400_000
"""Photons of each slab of a stated study."""

PARTS = ("frames", "horizons", "encode", "browser", "sessions", "pictures")
PICTURE = (640, 360)
"""Width and height of the documentation's pictures."""

PICTURE_BYTES = 60_000
"""Largest file of one."""


def add(commands: Any) -> None:
    """Declare the commands."""
    command = commands.add_parser("study", help="error of every combination of techniques against the reference")
    command.add_argument("scene", metavar="SCENE")
    command.add_argument("--presets", metavar="NAME,..", default="", help="all, or names (default: the scene's first)")
    command.add_argument("--suns", metavar="NAME,..", default="", help="all, names, or how many (default: 8 or all)")
    command.add_argument("--slots", metavar="NAME,..", default="", help="(default: shadow, light and geometry)")
    command.add_argument("--combinations", action="store_true", help="of the named combinations of techniques instead")
    command.add_argument("--kinds", action="store_true", help="of shadow instead: each technique in views of one kind")
    command.add_argument("--slab", action="store_true", help="of light within a plane cloud instead (clouds)")
    command.add_argument("--radiosity", action="store_true", help="of light between ground and clouds instead (clouds)")
    command.add_argument("--memory", action="store_true", help="of tables and their precomputation (directional)")
    command.add_argument("--faces", action="store_true", help="of faces, selection and codes instead (directional)")
    command.add_argument("--views", type=int, default=24, help="from which the subject is seen (with --faces)")
    command.add_argument("--rays", type=int, default=4096, help="of each point of its truth (with --radiosity)")
    cli_hemispheres.add(command)
    command.add_argument("--photons", type=int, default=PHOTONS, help="of each slab's truth (with --slab)")
    command.add_argument("--moving", type=int, default=64, help="side of pictures whose sun moves (with --kinds), px")
    command.add_argument("--steps", type=int, default=16, help="of the moving sun (with --kinds)")
    command.add_argument("--size", type=int, default=128, help="side of the pictures, px (default %(default)s)")
    command.add_argument("--frames", type=int, default=FRAMES, help="timed frames of each; 0 for no times")
    command.add_argument("--docs", action="store_true", help="copy tables and charts into docs/study")
    command.set_defaults(run=study)
    command = commands.add_parser("bench", help="frame times, encoding, latency in a browser, and pictures for docs")
    command.add_argument("scene", metavar="SCENE", nargs="?", default="forest")
    command.add_argument("--frames", type=int, default=FRAMES, help="timed frames of each (default %(default)s)")
    command.add_argument("--presets", metavar="NAME,..", default="all", help="all, or names (default %(default)s)")
    command.add_argument("--parts", metavar="NAME,..", default="all", help=f"of {', '.join(PARTS)} (default: all)")
    command.set_defaults(run=bench)


class Teller:
    """A bar fed with a share and words."""

    def __init__(self, name: str) -> None:
        self.bar = Bar()
        self._name = name
        self._start = time.monotonic()
        self._at = 0.0
        self._words = ""

    def __call__(self, share: float, words: str) -> None:
        """Show the share of the whole."""
        self._at, self._words = share, words
        self._show(words)

    def inner(self, share: float, words: str) -> None:
        """Show how far one step of the whole is."""
        self._show(f"{self._words}: {words} {share:.0%}")

    def _show(self, words: str) -> None:
        spent = time.monotonic() - self._start
        left = spent / self._at * (1 - self._at) if self._at > 0.02 else 0.0
        self.bar(Progress(self._name, self._at, words, left))


def names_of(option: str, text: str, every: tuple[str, ...], common: tuple[str, ...] = ()) -> tuple[str, ...]:
    """Names separated by commas, of `every`; `all`, or how many of the first, of `common` where that is given.

    Raises:
        InputError: a number that is none, or a name that there is not.
    """
    most = common or every
    if text == "all":
        return most
    if text.isdigit() and 1 <= int(text) <= len(most):
        return most[: int(text)]
    names = tuple(filter(None, text.split(",")))
    for name in names:
        if name not in every:
            raise InputError(option, f"{name} is not known", f"all, 1 to {len(most)}, or of {', '.join(every)}")
    return names


def presets_of(text: str, presets: Mapping[str, Mapping[str, Any]]) -> tuple[str, ...]:
    """Presets by name; all of them are those that were not made for one purpose."""
    common = tuple(name for name, preset in presets.items() if not preset["group"])
    return names_of("--presets", text, tuple(presets), common)


def study(given: argparse.Namespace) -> int:
    """Run a study and write its raw results, tables and charts."""
    from renderer import study_plan, studying  # charts take a second to import, which no other command should pay

    if given.frames < 0:
        raise InputError("--frames", "cannot be negative", f"0 for no times, {FRAMES} for stated ones")
    if given.kinds:
        return kinds(given)
    if given.radiosity:
        from server import cli_radiosity
        return cli_radiosity.study(given)
    if given.hemispheres:
        return cli_hemispheres.study(given)
    if given.slab:
        from server import cli_slab

        return cli_slab.study(given)
    if given.memory or given.faces:
        from server import cli_directional
        return (cli_directional.memory if given.memory else cli_directional.faces)(given)
    with Session() as session:
        scene = session.describe(given.scene)
        if not given.slots and not {*study_plan.SLOTS} <= {slot["name"] for slot in scene["slots"]}:
            return alone(session, given)
        slots = COMBINATION if given.combinations else given.slots
        suns = "all" if given.combinations else str(study_plan.SOME_SUNS)
        plan = study_plan.Plan(
            given.scene,
            presets_of(given.presets, scene["presets"]),
            names_of("--suns", given.suns or suns, tuple(study_plan.SUNS)),
            names_of("--slots", slots, study_plan.Plan.slots_of(given.scene)),
            given.size,
        ).checked()
        folder = Path(load().study) / given.scene
        tell = Teller(given.scene)
        try:
            studying.run(session, plan, folder, given.frames, tell, tell.inner)
        finally:
            tell.bar.close()
    if given.docs:
        for part in plan.judged.values():
            keep(folder / part, DOCS / "study" / given.scene / part, KEPT)
    homes = ", ".join(str(folder / part) for part in plan.judged.values())
    print(f"{homes}: results.jsonl, table.md, speed_accuracy.svg .png .csv")
    return 0


def alone(session: Session, given: argparse.Namespace) -> int:
    """Study each technique of a scene alone, in every preset under its own sun."""
    from renderer import alone_study

    if given.combinations or given.suns:
        raise InputError("--slots", "must be named where suns or combinations are chosen")
    presets = presets_of(given.presets, session.describe(given.scene)["presets"])
    folder = Path(load().study) / given.scene / "alone"
    tell = Teller(given.scene)
    try:
        alone_study.run(session, given.scene, folder, given.size, max(given.frames, 1), tell, presets)
    finally:
        tell.bar.close()
    if given.docs:
        keep(folder, DOCS / "study" / given.scene / "alone", alone_study.FILES)
        keep(folder, DOCS / "study" / given.scene / "techniques", ("facts.json",))
    print(f"{folder}: results.jsonl, facts.json, {', '.join(alone_study.FILES)}")
    return 0


def kinds(given: argparse.Namespace) -> int:
    """Run the table of shadow kinds and write its raw results, table and chart."""
    from renderer import kind_costs, kind_study

    if given.combinations or given.presets or given.suns or given.slots:
        raise InputError("--kinds", "has its own views, suns and techniques", "alone, with --size, --moving, --steps")
    plan = kind_study.Plan(given.scene, given.size, given.moving, given.steps).checked()
    folder = Path(load().study) / given.scene / KINDS
    tell = Teller(given.scene)
    try:
        with Session() as session:
            kind_costs.run(session, plan, folder, given.frames, tell)
    finally:
        tell.bar.close()
    if given.docs:
        keep(folder, DOCS / "study" / given.scene / KINDS, (*KEPT, kind_costs.RAW))
    print(f"{folder}: results.jsonl, raw.jsonl, table.md, speed_accuracy.svg .png .csv")
    return 0


def keep(folder: Path, docs: Path, names: tuple[str, ...]) -> None:
    """Copy what is small into the documentation."""
    docs.mkdir(parents=True, exist_ok=True)
    for name in names:
        shutil.copyfile(folder / name, docs / name)


def bench(given: argparse.Namespace) -> int:
    """Time everything, in one run on this machine, and write JSON lines, a table and the documentation's pictures."""
    from renderer import benching
    from server import bench_report

    parts = names_of("--parts", given.parts, PARTS)
    if given.frames < 1:
        raise InputError("--frames", "must be at least one", f"{FRAMES} for stated medians and percentiles")
    found: dict[str, Any] = {}
    with Session() as session:
        presets = presets_of(given.presets, session.describe(given.scene)["presets"])
        machine = benching.provenance(session.gl.info.renderer)
        tell = Teller(given.scene)
        try:
            first = session.state(given.scene, presets[0])
            session.prepare(first, tell.bar).future.result()
            if "frames" in parts:
                OUT.mkdir(parents=True, exist_ok=True)
                results = OUT / "frames.jsonl"
                results.unlink(missing_ok=True)
                found["frames"] = benching.time_frames(
                    session, given.scene, results, machine, given.frames, presets, tell
                )
            if "horizons" in parts:
                found["horizons"] = benching.time_horizons(progress=tell)
            found |= _doors(session, first, parts, tell)
            if "pictures" in parts:
                found["pictures"] = _pictures(session, given.scene, presets, tell)
        finally:
            tell.bar.close()
    bench_report.save(OUT, machine, found)
    print((OUT / "table.md").read_text(encoding="utf-8"), end="")
    return 0


def _doors(session: Session, first: Any, parts: tuple[str, ...], tell: Teller) -> dict[str, Any]:
    """Encoding, the browser and several sessions, as far as they are wanted."""
    from renderer.benching import SIZES
    from server import bench as doors

    found: dict[str, Any] = {}
    if "encode" in parts:
        pictures = [session.draw(first, width, height, 1).rgb8 for width, height in SIZES]
        found["encode"] = [line for rgb8 in pictures for line in doors.encoding(rgb8)]
    if "browser" in parts or "sessions" in parts:
        with doors.serving(session) as address:
            if "browser" in parts:
                tell(0.5, "dragging in a browser")
                found["browser"] = doors.browser(address)
            if "sessions" in parts:
                tell(0.8, "four sessions at once")
                found["sessions"] = doors.several(address, first.model_dump(mode="json"))
    return found


def _pictures(session: Session, scene: str, presets: tuple[str, ...], tell: Teller) -> list[str]:
    """Small pictures of each preset at three suns, into the documentation."""
    from renderer import benching
    from server.bench import small_jpeg

    folder = DOCS / "pictures"
    folder.mkdir(parents=True, exist_ok=True)
    wanted = [(preset, sun) for preset in presets for sun in benching.suns_of(scene)]
    written = []
    for number, (preset, sun) in enumerate(wanted):
        tell(number / len(wanted), f"picture of {preset}, {sun}".rstrip(", "))
        picture = session.render(benching.pictured(session, scene, preset, sun), *PICTURE)
        path = folder / f"{scene}_{preset}_{sun}.jpg".replace("_.jpg", ".jpg")
        path.write_bytes(small_jpeg(picture.rgb8, PICTURE_BYTES))
        written.append(path.name)
    return written
