"""The benchmark's results as files: JSON lines, and a table for people."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any


def save(folder: Path, machine: Mapping[str, Any], found: Mapping[str, Any]) -> None:
    """Write `bench.json` (everything but the frames, whose lines are beside it) and `table.md`.

    Args:
        folder: gets the files.
        machine: where it ran.
        found: results by part: `frames`, `horizons`, `encode`, `browser`, `sessions`, `pictures`, as far as they were
            measured.
    """
    folder.mkdir(parents=True, exist_ok=True)
    kept = {"machine": machine, "when": int(time.time()), **{k: v for k, v in found.items() if k != "frames"}}
    (folder / "bench.json").write_text(json.dumps(kept, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    (folder / "table.md").write_text("\n".join(_text(machine, found)) + "\n", encoding="utf-8")


def _text(machine: Mapping[str, Any], found: Mapping[str, Any]) -> Iterator[str]:
    yield (
        f"{machine['renderer']}, {machine['cores']} cores, {machine['system']}, Python {machine['python']}, "
        f"commit {machine['commit'][:12]}"
    )
    if "frames" in found:
        yield from _frames(found["frames"])
    if "horizons" in found:
        yield ""
        yield from _horizons(found["horizons"])
    if "encode" in found:
        yield ""
        yield from _rows(
            ("picture", "codec", "encode, ms", "kB"),
            [
                (
                    f"{line['size'][0]} x {line['size'][1]}, {line['when']}",
                    f"{line['codec']} {line['quality'] or ''}".strip(),
                    f"{line['encode_ms']:.1f}",
                    f"{line['bytes'] / 1e3:.0f}",
                )
                for line in found["encode"]
            ],
        )
    if "browser" in found:
        yield ""
        yield from _browser(found["browser"])
    if "sessions" in found:
        yield ""
        line = found["sessions"]
        rates = ", ".join(f"{rate:.1f}" for rate in line["pictures_per_second"])
        waits = ", ".join(f"{wait:.0f}" for wait in line["longest_wait_ms"])
        yield f"{line['sessions']} sessions, each its own camera: {rates} pictures a second; longest waits {waits} ms."


def _frames(lines: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """One row a case, what differs from the default technique in bold."""
    default = lines[0]["techniques"]
    rows = []
    for line in lines:
        changed = [f"{slot}: **{kind}**" for slot, kind in line["techniques"].items() if kind != default[slot]]
        moves = line["parameters"]["moves"]
        rows.append(
            (
                line["preset"],
                ", ".join(changed) or "default",
                moves,
                f"{line['size'][0]} x {line['size'][1]}",
                f"{line['frame_ms']:.1f}",
                f"{line['frame_ms_p95']:.1f}",
                f"{line['yardsticks']:.2f}",
                str(line["frames"]),
            )
        )
    yield ""
    yield f"Default: {' + '.join(default.values())}. One yardstick took {lines[0]['yardstick_ms']:.1f} ms at first."
    yield ""
    yield from _rows(("preset", "technique", "moves", "size", "median, ms", "p95, ms", "yardsticks", "frames"), rows)


def _horizons(lines: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """One row a grid: millions of cell-azimuths a second, and the sweep's distance from the exact search."""
    yield "Horizons of the default terrain, in millions of cells and azimuths a second; errors in degrees."
    yield ""
    yield from _rows(
        ("nodes", "sweep, a core", "sweep, all cores", "search, a core", "ratio", "median error", "p99 error"),
        [
            (
                f"{line['nodes']} x {line['nodes']}",
                f"{line['swept_per_core'] / 1e6:.1f}",
                f"{line['swept'] / 1e6:.1f}",
                f"{line['searched_per_core'] / 1e6:.3f}",
                f"{line['swept_per_core'] / line['searched_per_core']:.0f}",
                f"{line['median_error']:.4f}",
                f"{line['p99_error']:.3f}",
            )
            for line in lines
        ],
    )


def _browser(line: Mapping[str, Any]) -> Iterator[str]:
    if "missing" in line:
        yield f"Browser: not measured, {line['missing']}."
        return
    size = f"{line['size'][0]} x {line['size'][1]}"
    yield (
        f"Browser at {size}, quiet page, {line['moves']} moves: input to picture {line['latency_ms']:.0f} ms median, "
        f"{line['latency_p95_ms']:.0f} ms p95; render {line['render_ms']:.0f} ms, excess {line['excess_ms']:.0f} ms "
        f"(encode {line['encode_ms']:.1f}, decode {line['decode_ms']:.1f}); scale {line['single_scale']:.2f}."
    )
    yield ""
    yield (
        f"Dragging for {line['drag_seconds']:.0f} s: {line['pictures_per_second']:.1f} pictures a second at a linear "
        f"scale of {line['scale']:.2f} (least {line['lowest_scale']:.2f}), {line['bytes'] / 1e3:.0f} kB each; render "
        f"{line['drag_render_ms']:.0f} ms, encode {line['drag_encode_ms']:.1f} ms."
    )


def _rows(heading: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[str]:
    for row in (heading, ["---"] * len(heading), *rows):
        yield "| " + " | ".join(row) + " |"
