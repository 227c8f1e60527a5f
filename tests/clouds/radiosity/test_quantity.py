"""`measure radiosity`: each technique against the quadrature, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.core.errors import InvalidDocument
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
