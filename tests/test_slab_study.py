"""The study of light in a plane cloud: what it finds with few photons, and that its errors are errors."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from renderer import slab_report, slab_study
from renderer.clouds.droplets import Droplets
from renderer.core.cache import Cache
from renderer.reference.cloud_shell import Shell
from renderer.reference.cloud_shell_single import chord, plane_single, sphere_single
from renderer.reference.cloud_slab import SlabPhotons
from server import cli


def silent(share: float, words: str) -> None:
    """Nobody listens."""


class Even:
    """A model that sends 1 / pi everywhere."""

    def up(self, slab: object) -> np.ndarray:
        return np.full((*slab.cosine.shape, 3), slab.mu_sun[..., None] / np.pi)  # type: ignore[attr-defined]

    down = up


def even_photons(count: int) -> SlabPhotons:
    """So many photons that left by the cosine law."""
    edges = np.linspace(0, 1, 11), np.linspace(0, np.pi, 7)
    bins = np.zeros((4, 10, 6), np.int64)
    bins[1] = np.rint(np.diff(edges[0] ** 2)[:, None] * np.diff(edges[1]) / np.pi * count)
    return SlabPhotons(count, bins.sum(axis=(1, 2)), bins.sum(axis=(1, 2)), bins, bins, *edges)


def test_a_technique_that_is_right_has_no_error() -> None:
    model, found = Even(), even_photons(1_000_000)
    assert slab_study.binned(model, found, 2.0, 0.5, True) == pytest.approx(np.full((10, 6), 1 / np.pi))
    right = slab_study.radiance_errors(model, found, 2.0, 0.5, True)
    assert right["median"] < 1e-4
    assert right["rms"] == 0
    bright = slab_study.radiance_errors(model, even_photons(500_000), 2.0, 0.5, True)
    assert right["noise"] < bright["noise"]


def test_a_technique_that_is_wrong_has_its_error() -> None:
    found = even_photons(1_000_000)
    half = SlabPhotons(2_000_000, found.up, found.down, found.up_bins, found.down_bins,
                       found.cosine_edges, found.azimuth_edges)
    wrong = slab_study.radiance_errors(Even(), half, 2.0, 0.5, True)
    assert wrong["median"] == pytest.approx(1, abs=1e-3)
    assert wrong["rms"] == pytest.approx(1, abs=0.01)


def test_bins_beside_the_sun_are_left_out() -> None:
    found = even_photons(1000)
    assert slab_study.beside_the_sun(found, 0.75, False)[7, 0]
    assert not slab_study.beside_the_sun(found, 0.75, False)[7, 5]
    assert not slab_study.beside_the_sun(found, 0.75, True).any()


def test_order_2_as_printed_is_twice_too_bright(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Droplets of nearly one size stand in for those of formulas a4, to which the technique's own test is held."""
    monkeypatch.setattr(slab_study, "HANSEN", Droplets(radius=7, width=0.01))
    lines = slab_study.order_numbers(20_000, Cache(tmp_path), silent)
    line = next(line for line in lines if line["depth"] == 2.0)
    share, error = line["second"]
    assert abs(line["corrected"] - share) < 3 * error
    assert line["thesis"] - share > 15 * error
    assert 1.9 < line["thesis"] / line["corrected"] < 2.2


@pytest.mark.parametrize(("extinction", "degrees", "off"), [
    (0.005, 85, -3.6e-4), (0.005, 89, -1.8e-3), (0.04, 85, -4.5e-5), (0.04, 89, -2.3e-4), (0.1, 89, -9e-5),
])
def test_the_plane_is_dark_by_little(extinction: float, degrees: float, off: float) -> None:
    """Errata 001-18."""
    shell, angle = Shell(6.35e6, 2500.0, 250.0, extinction), np.radians(degrees)
    assert plane_single(shell, angle, angle) / sphere_single(shell, angle, angle) - 1 == pytest.approx(off, rel=0.03)
    flat = Shell(6.35e12, 2500.0, 250.0, extinction)
    assert sphere_single(flat, 0.7, 0.3) == pytest.approx(plane_single(flat, 0.7, 0.3), rel=1e-6)


def test_only_droplets_have_a_bow_and_a_glory() -> None:
    mie, lobe, air = slab_study.contrast_numbers()
    assert mie["bow"] > 1.3
    assert mie["ring"] > 1.15
    for smooth in (lobe, air):
        assert smooth["bow"] == pytest.approx(1, abs=0.02)
        assert smooth["ring"] == pytest.approx(1, abs=0.01)


def test_a_planes_path_explodes_at_the_horizon() -> None:
    lines = {line["degrees"]: line for line in slab_study.path_numbers()}
    assert lines[60.0]["plane"] == pytest.approx(lines[60.0]["sphere"], rel=1e-3)
    assert lines[89.9]["plane"] > 4 * lines[89.9]["sphere"]


def test_a_chord_is_one_crossing() -> None:
    """At the angle that just meets the ground, 17,399 m (errata 001-1); beyond the base's rim both ends are on top."""
    shell = Shell(6.35e6, 2500.0, 250.0, 1.0)
    rim = float(np.arcsin(shell.radius / (shell.radius + 2750)))
    assert 2 * chord(shell, rim) == pytest.approx(17399, rel=1e-3)
    assert chord(shell, np.radians(89.9)) == pytest.approx(2 * (shell.radius + 2750) * np.cos(np.radians(89.9)))


@pytest.mark.slow
def test_the_whole_study_writes_its_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(slab_study, "DEPTHS", (2.0,))
    monkeypatch.setattr(slab_study, "SUNS", (0.7,))
    monkeypatch.setenv("UMBRAGE_STUDY", str(tmp_path))
    assert cli.main(["study", "clouds", "--slab", "--photons", "2000"]) == 0
    folder = tmp_path / "clouds" / "slab"
    lines = [json.loads(line) for line in (folder / "results.jsonl").read_text().splitlines()]
    assert {line["part"] for line in lines} == {
        "errors", "orders", "lobe", "droplets", "sphere", "contrast", "path"}
    errors = {line["technique"]: abs(line["off_reflectance"]) for line in lines if line["part"] == "errors"}
    assert set(errors) == set(slab_report.ORDER)
    assert errors["adding_doubling"] < 0.04 < errors["single"]
    assert "| adding_doubling |" in (folder / "table.md").read_text()
    for name in slab_report.FILES:
        assert (folder / name).stat().st_size > 500


@pytest.mark.parametrize(("words", "refused"), [
    (["forest", "--slab"], "has no clouds"), (["clouds", "--slab", "--photons", "3"], "too few"),
])
def test_what_cannot_be_studied_is_refused(words: list[str], refused: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["study", *words]) == cli.REFUSED
    assert refused in capsys.readouterr().err
