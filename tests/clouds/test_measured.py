"""The quantities `mie` and `slab`: names, axes, values, and what they refuse."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.core.errors import InputError, UmbrageError
from renderer.study import measure as door
from tests.clouds.scattering import ladder

GRID = {"width": 0.01, "optical_depths": ladder.AT_DEPTHS.tolist(), "sun_cosines": ladder.AT_SUNS.tolist(),
        "view_cosines": ladder.AT_VIEWS.tolist(), "azimuths": [15.0, 90.0, 180.0]}


def test_droplets_are_measured() -> None:
    """Values of the shared `b_mie_summary.json`."""
    found = door.measure("mie", {"width": 0.01, "wavelengths": [650.0]})
    arrays, name = found.arrays, "normal_01pct_650nm"
    assert arrays["g"] == pytest.approx([0.8591864044], rel=1e-8)
    assert arrays["Qext"] == pytest.approx([2.033514621], rel=1e-8)
    assert arrays["ssa"] == pytest.approx([0.9999965838], rel=1e-8)
    assert arrays["effective_radius_um"] == pytest.approx([10.001998], rel=1e-6)
    assert arrays["forward_5deg"] == pytest.approx([0.464], abs=1e-3)
    assert arrays["fogbow_deg"] == pytest.approx([38.45], abs=0.1)
    assert arrays[f"{name}_glory_deg"][:3] == pytest.approx([1.8, 3.85, 5.7], abs=0.05)
    assert arrays[f"{name}_P"][0] == pytest.approx(379.7661773, rel=1e-8)
    assert arrays[f"{name}_P"].shape == arrays["angle_deg"].shape == (1751,)
    assert arrays[f"{name}_leg"].shape == (600,)


def test_an_index_may_be_given_and_is_asked_for_beyond_the_table() -> None:
    given = {"wavelengths": [1600.0], "width": 0.01, "indices": [[1.317, 8.0e-5]]}
    assert door.measure("mie", given).arrays["ssa"][0] < 0.995
    with pytest.raises(InputError, match="table"):
        door.measure("mie", {"wavelengths": [1600.0]})
    with pytest.raises(UmbrageError, match="size parameter"):
        door.measure("mie", {"radius": 50.0, "width": 0.5})
    with pytest.raises(InputError, match="each wavelength"):
        door.measure("mie", {"wavelengths": [500.0, 600.0], "indices": [[1.33, 0.0]]})


@pytest.mark.parametrize(("technique", "flux", "up", "down"), [
    ("doubling", 2e-4, 5e-4, 5e-4), ("adding_doubling", 1.5e-3, 5e-3, 1e-2),
])
def test_a_slab_is_measured(technique: str, flux: float, up: float, down: float) -> None:
    found = door.measure("slab", {**GRID, "technique": technique})
    arrays = found.arrays
    assert arrays["R"].shape == (1, 1, 2, 2)
    assert arrays["L_up"].shape == (1, 1, 2, 2, 2, 3)
    known = ladder.REFLECTANCE[np.ix_([1, 3], [1, 3])]
    assert arrays["R"][0, 0] == pytest.approx(known, rel=flux)
    assert arrays["T_total"][0, 0] == pytest.approx(1 - known, rel=2 * flux)
    assert arrays["T_direct"][0, 0] == pytest.approx(np.exp(-ladder.AT_DEPTHS[:, None] / ladder.AT_SUNS))
    assert np.median(np.abs(arrays["L_up"][0, 0] / ladder.UP - 1)) < up
    assert np.median(np.abs(arrays["L_down"][0, 0] / ladder.DOWN - 1)) < down
    assert f"technique: {technique}" in found.meta["notes"]


def test_absorption_is_the_solvers() -> None:
    """Values of the shared `a_slab.npz`: omega 0.9999, depth 128, sun at 0.7, Henyey-Greenstein."""
    lobe = {"phase": "henyey_greenstein", "asymmetry": 0.85, "optical_depths": [128.0], "sun_cosines": [0.7],
            "view_cosines": [0.5], "azimuths": [90.0], "albedos": [1.0, 0.9999]}
    found = door.measure("slab", {**lobe, "technique": "doubling"}).arrays
    assert found["R"][0, :, 0, 0] == pytest.approx([0.93313, 0.91707], rel=1e-4)
    assert found["T_total"][0, :, 0, 0] == pytest.approx([0.06685, 0.05827], rel=1e-3)
    with pytest.raises(InputError, match="absorb nothing"):
        door.measure("slab", {**lobe, "technique": "orders"})


@pytest.mark.parametrize("technique", ["delta_eddington", "orders", "single", "thesis_orders"])
def test_every_technique_is_measured(technique: str) -> None:
    found = door.measure("slab", {"phase": "rayleigh", "optical_depths": [0.0, 0.3], "sun_cosines": [0.8],
                                  "view_cosines": [0.5], "azimuths": [0.0], "technique": technique}).arrays
    assert found["R"][0, 0, 0, 0] == pytest.approx(0, abs=1e-9)
    assert 0.08 < found["R"][0, 0, 1, 0] < 0.3
    assert found["L_up"][0, 0, 0, 0] == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize(("given", "words"), [
    ({"optical_depths": [-1.0]}, "optical_depths"),
    ({"technique": "magic"}, "technique"),
    ({"view_cosines": [0.5] * 64, "azimuths": [1.0] * 64, "sun_cosines": [0.5] * 64, "optical_depths": [1.0] * 64},
     "at most"),
    ({"technique": "doubling", "optical_depths": [1.0] * 64, "albedos": [0.5] * 8}, "layers"),
])
def test_a_wrong_slab_is_refused(given: dict, words: str) -> None:
    with pytest.raises(UmbrageError, match=words):
        door.measure("slab", given)
