"""A sweep over a made-up phenomenon whose errors and times are known."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from renderer.core.errors import Cancelled, GLUnavailable, InputError
from renderer.study.charts import pareto, speed_accuracy, summarise, table, write
from renderer.study.sweep import FRAMES, WARM_UP, Case, Drawn, clock, compare, provenance, read, sweep

MACHINE = {"renderer": "llvmpipe (test)", "cores": 2, "commit": "abc"}
ERRORS = {"good": 0.1, "middling": 0.2, "bad": 0.4}
TIMES = {"good": 20.0, "middling": 30.0, "bad": 5.0}
CASES = [Case("noon", sun, {"shadow": kind, "light": "plain"}) for sun in ("east", "west") for kind in ERRORS]


def flat(value: float, noise: float = 0.0) -> Drawn:
    linear = np.full((16, 16, 4), value)
    once = linear + noise * np.where(np.arange(16) % 2, 1.0, -1.0)[None, :, None]
    return Drawn(linear, np.full((16, 16, 3), round(100 * value), np.uint8), once, 2.0, 0.005)


class World:
    def __init__(self) -> None:
        self.drawn: list[Case] = []

    def draw(self, case: Case) -> Drawn:
        self.drawn.append(case)
        return flat(1 + ERRORS[case.techniques["shadow"]] * (2 if case.sun == "west" else 1), noise=0.3)

    def truth(self, case: Case) -> Drawn:
        return flat(1.0, noise=0.2)


def same(case: Case) -> str:
    return "shader 1"


def test_raw_results_carry_errors_machine_parameters_and_seed(tmp_path: Path) -> None:
    lines = sweep(tmp_path / "r.jsonl", CASES, World().draw, World().truth, same, MACHINE)
    assert [line["relative_rmse"] for line in lines] == pytest.approx([0.1, 0.2, 0.4, 0.2, 0.4, 0.8])
    assert lines == read(tmp_path / "r.jsonl")
    first = lines[0]
    assert (first["preset"], first["sun"], first["seed"], first["size"]) == ("noon", "east", 0, [16, 16])
    assert first["machine"] == MACHINE
    assert first["pairing"] == pytest.approx(0.3 / 0.2)
    # one gain makes a flat picture equal to a flat reference
    assert first["relative_rmse_after_gain"] == pytest.approx(0, abs=1e-12)
    assert first["gain"] == pytest.approx(1 / 1.1)
    assert first["reference_standard_error"] == 0.005


def test_the_references_own_noise_is_no_error_of_the_picture() -> None:
    exact = np.random.default_rng(4).uniform(0.5, 1.5, (128, 128, 1)) * [1.0, 0.8, 0.4]
    noise = np.random.default_rng(5).normal(0, 0.3, (128, 128, 1)) * np.ones(3)
    shown = np.zeros((128, 128, 3), np.uint8)
    judged = Drawn(exact + noise, shown, standard_error=0.3 / exact.mean())
    found = compare(Drawn(exact * 1.1, shown), judged)
    right = 0.1 * np.sqrt((exact**2).mean()) / exact.mean()
    assert found["relative_rmse"] > 3 * right
    # Of 16,384 pixels the noise's own square is known to 1 %, and what is left to a tenth of it.
    assert found["relative_rmse_without_noise"] == pytest.approx(right, rel=0.15)
    assert compare(judged, judged)["relative_rmse_without_noise"] == 0


def test_a_stopped_sweep_goes_on_where_it_was(tmp_path: Path) -> None:
    world, path = World(), tmp_path / "r.jsonl"

    def stop(share: float, words: str) -> None:
        if len(world.drawn) == 2:
            raise Cancelled("enough")

    with pytest.raises(Cancelled):
        sweep(path, CASES, world.draw, world.truth, same, MACHINE, stop)
    assert len(read(path)) == 2
    with path.open("a") as file:
        file.write('{"kind": "error", "torn')  # a writer that was killed
    after = World()
    lines = sweep(path, CASES, after.draw, after.truth, same, MACHINE)
    assert after.drawn == CASES[2:]
    assert len(lines) == len(read(path)) == 6


def test_a_changed_method_cannot_keep_its_old_score(tmp_path: Path) -> None:
    path = tmp_path / "r.jsonl"
    sweep(path, CASES, World().draw, World().truth, same, MACHINE)
    again = World()
    sweep(
        path,
        CASES,
        again.draw,
        again.truth,
        lambda case: f"shader {2 if case.techniques['shadow'] == 'bad' else 1}",
        MACHINE,
    )
    assert {case.techniques["shadow"] for case in again.drawn} == {"bad"}
    assert len(summarise(read(path))) == 3, "the later result replaces the earlier one"


def test_a_technique_that_this_machine_lacks_is_told_and_left_out(tmp_path: Path) -> None:
    def draw(case: Case) -> Drawn:
        if case.techniques["shadow"] == "bad":
            raise GLUnavailable("needs OpenGL 4.3")
        return World().draw(case)

    lines = sweep(tmp_path / "r.jsonl", CASES, draw, World().truth, same, MACHINE)
    assert lines[2]["failed"] == "needs OpenGL 4.3"
    assert {p.techniques["shadow"] for p in summarise(lines)} == {"good", "middling"}


def test_damage_in_the_middle_is_named(tmp_path: Path) -> None:
    path = tmp_path / "r.jsonl"
    path.write_text('{"kind": "err\n{}\n')
    with pytest.raises(InputError, match="line 1"):
        read(path)


def test_frames_are_timed_in_turns_after_a_warm_up(tmp_path: Path) -> None:
    order: list[str] = []

    def frame(case: Case) -> float:
        kind = case.techniques["shadow"]
        order.append(kind)
        # a cold start that the warm-up must swallow
        return 1e4 if order.count(kind) <= WARM_UP else TIMES[kind] + order.count(kind) % 2

    lines = clock(tmp_path / "r.jsonl", CASES[:3], frame, (512, 512), MACHINE, yardstick=lambda: 40.0)
    assert order[:6] == ["good", "middling", "bad"] * 2
    assert len(order) == 3 * (WARM_UP + FRAMES)
    assert [line["frame_ms"] for line in lines] == pytest.approx([20.5, 30.5, 5.5])
    assert lines[0]["frame_ms_p95"] == pytest.approx(21)
    assert lines[2]["yardsticks"] == pytest.approx(5.5 / 40)


def test_pareto_front_by_hand() -> None:
    nan = float("nan")
    assert pareto([1, 2, 3, 2, nan], [0.5, 0.3, 0.4, 0.2, 0.1]) == [True, False, False, True, False]
    assert pareto([1, 1], [0.5, 0.5]) == [True, True], "equal pairs do not beat each other"


def test_summary_table_and_chart_files(tmp_path: Path) -> None:
    path = tmp_path / "r.jsonl"
    sweep(path, CASES, World().draw, World().truth, same, MACHINE)
    clock(path, CASES[:3], lambda case: TIMES[case.techniques["shadow"]], (512, 512), MACHINE)
    points = write(path, tmp_path / "out", "Made up, llvmpipe", "shadow", "light")
    assert [p.techniques["shadow"] for p in points] == ["good", "middling", "bad"]
    assert [p.error for p in points] == pytest.approx([0.15, 0.3, 0.6])
    assert [p.worst for p in points] == pytest.approx([0.2, 0.4, 0.8])
    assert [p.on_front for p in points] == [True, False, True], "middling is slower and worse than good"
    text = (tmp_path / "out" / "table.md").read_text().splitlines()
    assert text[:2] == ["Made up, llvmpipe", ""]
    assert len(text) == 7
    assert "**good**" in text[4]
    assert "| middling |" in text[5]
    csv = (tmp_path / "out" / "speed_accuracy.csv").read_text().splitlines()
    assert csv[0].startswith("light,shadow,error,worst")
    assert float(csv[1].split(",")[2]) == pytest.approx(0.15)
    assert (tmp_path / "out" / "speed_accuracy.png").read_bytes()[:4] == b"\x89PNG"
    svg = (tmp_path / "out" / "speed_accuracy.svg").read_text()
    assert "</svg>" in svg
    eastern = write(path, tmp_path / "east", "East", "shadow", keep=lambda line: line["sun"] == "east")
    assert [p.error for p in eastern] == pytest.approx([0.1, 0.2, 0.4])
    write(path, tmp_path / "again", "Made up, llvmpipe", "shadow", "light")
    assert (tmp_path / "again" / "table.md").read_text() == (tmp_path / "out" / "table.md").read_text()


def test_the_chart_shows_what_it_is_given() -> None:
    base = {"kind": "error", "preset": "p", "sun": "s", "parameters": {}, "seed": 0, "machine": MACHINE}
    lines = [{**base, "techniques": {"shadow": kind}, "relative_rmse": e, "relative_rmse_after_gain": e, "flip_mean": e}
             for kind, e in ERRORS.items()]
    lines += [{**line, "kind": "time", "frame_ms": TIMES[line["techniques"]["shadow"]]} for line in lines]
    axes = speed_accuracy(summarise(lines), "x", "shadow").axes[0]
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    front = next(line for line in axes.lines if line.get_label() == "Pareto front")
    assert np.array(front.get_xydata()) == pytest.approx(np.array([[5, 0.4], [20, 0.1]]))
    assert "reference" not in " ".join(str(line.get_label()) for line in axes.lines)
    assert table(summarise(lines)).count("\n") == 5


def test_different_machines_never_share_a_chart() -> None:
    base = {"kind": "error", "techniques": {"a": "b"}, "preset": "p", "sun": "s", "parameters": {}, "seed": 0}
    with pytest.raises(InputError, match="2 renderers"):
        summarise([{**base, "machine": {"renderer": name}} for name in ("llvmpipe", "a card")])
    with pytest.raises(InputError, match="0 renderers"):
        summarise([])
    with pytest.raises(InputError, match="device"):
        provenance(" ")


def test_provenance_names_the_commit() -> None:
    found = provenance("llvmpipe")
    assert json.dumps(found)
    assert len(found["commit"]) >= 40 or found["commit"] == "unknown"
