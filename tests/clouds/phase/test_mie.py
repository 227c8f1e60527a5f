"""The tabulated phase function: its twin, its integral, and the sharpness it must keep."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.clouds.legendre import gauss, values_of
from renderer.clouds.phase.mie import Mie
from renderer.clouds.phase_tables import SUN_RADIUS, look_up, phase_arrays, table_cosines, table_place
from tests.clouds.phase.angles import COSINES, integral

Ask = Callable[..., np.ndarray]
Baked = Callable[..., dict[str, np.ndarray]]
MIE = Mie(width=0.01, sun_disc=False)


def error(ask: Ask, baked: Baked, body: str, name: str) -> float:
    found = ask({"phase": MIE}, body, {"c": COSINES})
    return float(np.abs(found / look_up(baked(MIE.phase_bake())[name], COSINES) - 1).max())


@pytest.mark.parametrize(("body", "name"), [("phase_value(c)", "value"), ("phase_twice(c)", "twice")])
def test_the_shader_reads_the_table(ask: Ask, baked: Baked, body: str, name: str) -> None:
    # Float32 has 2e-5 of an entry near 180 degrees, where the glory changes by a tenth from one entry to the next.
    assert error(ask, baked, body, name) < 3e-4


@pytest.mark.parametrize(("right", "wrong"), [
    ("angle_place(cosine)", "angle_place(-cosine)"),
    ("0.25 + 0.5 * row", "0.75 - 0.5 * row"),
    ("* (PHASE_ENTRIES - 1.0) + 0.5)", "* PHASE_ENTRIES)"),
])
def test_a_wrong_reading_is_found(ask: Ask, baked: Baked, spoil: Callable, right: str, wrong: str) -> None:
    with spoil("clouds/phase/mie.glsl", right, wrong):
        assert error(ask, baked, "phase_value(c)", "value") > 3e-3


def test_the_table_keeps_peak_bow_and_rings(baked: Baked) -> None:
    """Between entries it errs by 4 % at most, in the dark rings of droplets of one size."""
    arrays = baked(MIE.phase_bake())
    exact = np.stack([values_of(band, COSINES) for band in arrays["moments"]], axis=1)
    off = np.abs(look_up(arrays["value"], COSINES) / exact - 1)
    assert off.max() < 5e-2
    assert np.median(off) < 5e-4
    assert np.quantile(off, 0.9) < 2e-3
    assert table_place(table_cosines()) == pytest.approx(np.arange(len(table_cosines())), abs=1e-3)


def test_the_suns_disc_blurs_the_rings() -> None:
    """In the middle of a disc stands its mean over it: here of a lobe, by quadrature."""
    moments = 0.9 ** np.arange(250)
    sharp, blurred = (phase_arrays(np.tile(moments, (3, 1)), radius) for radius in (0.0, SUN_RADIUS))
    rim = np.linspace(np.cos(SUN_RADIUS), 1, 2001)
    mean = np.mean((1 - 0.81) / (4 * np.pi) / (1 + 0.81 - 1.8 * rim) ** 1.5)
    assert blurred["value"][0] == pytest.approx(np.full(3, mean), rel=1e-4)
    assert (sharp["value"][0] > blurred["value"][0]).all()


def test_the_integral_over_the_sphere_is_one(ask: Ask) -> None:
    nodes, weights = gauss(500)
    for body in ("phase_value(c)", "phase_twice(c)"):
        assert integral(ask({"phase": MIE}, body, {"c": nodes}), nodes, weights) == pytest.approx([1, 1, 1], abs=1e-3)


def test_the_peak_holds_half_of_the_light(baked: Baked) -> None:
    """Share within 5 degrees, 650 / 550 / 450 nm: 46.4, 47.1 and 49.6 % (errata 001-23)."""
    assert baked(MIE.phase_bake())["forward"] == pytest.approx([0.464, 0.471, 0.496], abs=2.5e-3)
