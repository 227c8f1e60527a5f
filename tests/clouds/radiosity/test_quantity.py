"""`measure radiosity`: each technique against the quadrature, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from renderer.clouds.radiosity import measured_relief
from renderer.clouds.radiosity.relief import cast
from renderer.core.errors import InputError, InvalidDocument
from renderer.study import measure as door


def errors(**arguments: object) -> np.ndarray:
    """Worst distance of the ground's sum from the quadrature's in the inner half of the disc, by bounce."""
    asked = {"radii": [8], "bounces": 4, **arguments}
    found = door.measure("radiosity", asked).arrays["err_ground_Rc8"]
    exact = door.measure("radiosity", {**asked, "technique": "exact"}).arrays["err_ground_Rc8"]
    return np.abs(found - exact)[:, :80].max(axis=1)


def test_names_and_axes_are_those_of_the_reference_values() -> None:
    found = door.measure("radiosity", {"radii": [4, 16], "bounces": 3, "distance": 500.0})
    assert found.arrays["err_ground_Rc16"].shape == found.arrays["err_cloud_Rc4"].shape == (3, 161)
    np.testing.assert_allclose(found.arrays["r_over_H_Rc4"], np.arange(161) * 0.025)
    assert found.arrays["r_Rc4_m"][-1] == pytest.approx(2000)
    np.testing.assert_allclose(found.arrays["exact_ground_cum"], [0.3, 0.381, 0.40287])
    np.testing.assert_allclose(found.arrays["exact_cloud_cum"], [1.27, 1.3429, 1.362583])
    assert found.arrays["endless_cloud"] == pytest.approx(1.369863014)
    assert found.arrays["ground_cum_Rc16"][0, 0] == pytest.approx(0.3 * (1 - 1 / 257))


def test_the_kernel_on_a_grid_is_near_the_quadrature() -> None:
    assert errors(technique="fft").max() < 5e-4


@pytest.mark.parametrize(
    ("reading", "least", "most"),
    [
        ("texels", 0.08, 0.2),
        ("taps", 0.02, 0.06),
        ("discs", 0.02, 0.08),
    ],
)
def test_three_levels_err_as_they_do(reading: str, least: float, most: float) -> None:
    assert least < errors(technique="three_level", reading=reading).max() < most


def test_the_distance_scales_away() -> None:
    near, far = (door.measure("radiosity", {"distance": d}).arrays["err_ground_Rc16"] for d in (500.0, 2500.0))
    assert (near == far).all()


def test_a_black_ground_and_perfect_mirrors_are_answered() -> None:
    black = door.measure("radiosity", {"ground_albedo": 0})
    assert "err_ground_Rc16" not in black.arrays
    assert (black.arrays["cloud_cum_Rc16"] == 1).all()
    white = door.measure("radiosity", {"ground_albedo": 1, "cloud_albedo": 1})
    assert "endless_ground" not in white.arrays
    assert any("no sum" in note for note in white.meta["notes"])


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("ground_albedo", 1.1),
        ("cloud_albedo", -0.1),
        ("distance", 0),
        ("radii", []),
        ("radii", [0.1]),
        ("radii", [65]),
        ("bounces", 0),
        ("bounces", 65),
        ("technique", "magic"),
        ("reading", "mips"),
        ("radii", [float("nan")]),
    ],
)
def test_bad_arguments_are_refused_by_name(field: str, value: object) -> None:
    with pytest.raises(InvalidDocument) as refused:
        door.measure("radiosity", {field: value})
    assert refused.value.errors[0].field.startswith(field)


@pytest.mark.parametrize(("basis", "most"), [("object", 5e-3), ("solid_angle", 1e-2), ("haar", 5e-3)])
def test_matrices_are_near_the_quadrature(basis: str, most: float) -> None:
    asked = {"radii": [16], "bounces": 4, "technique": "transfer", "basis": basis}
    exact = door.measure("radiosity", {**asked, "technique": "exact"}).arrays
    found = door.measure("radiosity", asked).arrays
    for side in ("ground", "cloud"):
        distance = np.abs(found[f"err_{side}_Rc16"] - exact[f"err_{side}_Rc16"])[:, :80].max()
        assert distance < most


@pytest.fixture
def valley(tmp_path: Path) -> Path:
    """A round plain of radius 2 km among highlands 700 m above it."""
    places = np.linspace(-16_000, 16_000, 161)
    far = np.hypot(places[:, None], places[None, :])
    path = tmp_path / "valley.npz"
    np.savez(path, elevation=700 * np.clip((far - 2000) / 2000, 0, 1), cell_size=np.array([200.0, 200.0]))
    return path


def test_over_a_terrain_relief_counts(valley: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(measured_relief, "cast", lambda nodes, progress: cast(nodes, 64, progress))
    asked = {"distance": 1000.0, "bounces": 3, "ground_albedo": 0.6, "basis": "object"}
    level, relief = (
        door.measure("radiosity", {**asked, "technique": technique}, {"terrain": valley}).arrays
        for technique in ("fft", "transfer")
    )
    assert relief["ground_cum"].shape == level["cloud_cum"].shape == (3, 64, 64)
    assert relief["y_m"][0] == -relief["y_m"][-1] == pytest.approx(15_750)
    middle = (-1, 32, 32)
    assert relief["elevation_m"][32, 32] == pytest.approx(0, abs=20)
    assert relief["elevation_m"][2, 2] == pytest.approx(700, abs=20)
    assert relief["ground_cum"][middle] < level["ground_cum"][middle] - 0.01, "the walls hide cloud"
    assert np.all(np.diff(relief["ground_cum"], axis=0) > 0)


def test_what_relief_does_not_allow_is_refused(valley: Path, tmp_path: Path) -> None:
    for arguments, field in (
        ({}, "technique"),
        ({"technique": "fft", "ground_albedo": 1, "cloud_albedo": 1}, "ground_albedo"),
        ({"technique": "transfer", "distance": 600.0}, "elevation"),
    ):
        with pytest.raises(InputError) as refused:
            door.measure("radiosity", arguments, {"terrain": valley})
        assert refused.value.field == field
    with pytest.raises(InputError) as refused:
        door.measure("radiosity", {"technique": "transfer", "radii": [20]})
    assert refused.value.field == "radii"
