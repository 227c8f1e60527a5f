"""Tables between their nodes: nodes kept, rulers that find them, MERL's coordinates, and what interpolation costs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from renderer.core.cache import AssetStore
from renderer.core.errors import LimitError
from renderer.directional.brdf import resident
from renderer.directional.brdf.lookup import between, coordinates_of, lookup
from renderer.directional.brdf.materials import File, Metal, Satin, Validation
from renderer.directional.brdf.resident import plane, ruler, table_uniforms
from renderer.reference.directional_brdf import reflected
from renderer.reference.directional_world import Measured
from renderer.world.brdf import PERIODS, BrdfTable, direction_of
from renderer.world.brdf_files import MERL_SHAPE
from tests.directional.light.points import random_directions


@pytest.mark.parametrize("source", [Validation(), Validation(azimuths="both"), Satin()], ids=repr)
def test_nodes_keep_their_values(source: Validation | Satin) -> None:
    table = source.table()
    view, light = (ways.reshape(-1, 3) for ways in table.node_directions())
    error = np.abs(lookup(table, view, light) - table.values.reshape(-1, 3))
    assert error.max() < 1e-9 * table.values.max() + 1e-9


def test_the_half_vectors_coordinates_are_rusinkiewiczs() -> None:
    """Built forward: a half vector, and a light turned about it; the view is its mirror image."""
    rng = np.random.default_rng(1)
    theta_h, phi_h = rng.uniform(0.1, 0.6, 200), rng.uniform(-np.pi, np.pi, 200)
    theta_d, phi_d = rng.uniform(0.1, 0.6, 200), rng.uniform(0.05, np.pi - 0.05, 200)
    half, x = direction_of(theta_h, phi_h), direction_of(theta_h + np.pi / 2, phi_h)
    y, d = np.cross(half, x), direction_of(theta_d, phi_d)
    light = d[:, :1] * x + d[:, 1:2] * y + d[:, 2:] * half
    view = -d[:, :1] * x - d[:, 1:2] * y + d[:, 2:] * half
    root, _, found_d, found_phi = coordinates_of(Metal().table(), view, light)
    np.testing.assert_allclose(root**2 * np.pi / 2, theta_h, rtol=1e-9)
    np.testing.assert_allclose(found_d, theta_d, rtol=1e-9)
    np.testing.assert_allclose(np.mod(found_phi, np.pi), phi_d, rtol=1e-9)


def merl_like(source: Metal) -> BrdfTable:
    """The metal with the cells of a MERL file."""
    table = source.table(MERL_SHAPE)
    assert table.values.shape == (90, 1, 90, 180, 3)
    return table


def test_a_files_own_coordinates_err_least() -> None:
    """Rough metal (alpha 0.15) through the cells of a MERL file: linear between them it errs by 0.14 % (rms over rms),
    by the nearest cell, as the database's own reader takes it, by 3.3 %, resampled at every 5 degrees of view, light
    and azimuth by 5.7 %. So files are drawn in their own coordinates, linear between cells."""
    source = Metal(roughness=0.15)
    table = merl_like(source)
    view, light = random_directions(4000, 1), random_directions(4000, 2)
    high = (view[:, 2] > 0.26) & (light[:, 2] > 0.26)  # 75 degrees
    view, light = view[high], light[high]
    right = source.reflectance(view, light)
    scale = np.sqrt((right**2).mean())
    linear = lookup(table, view, light)
    at = coordinates_of(table, view, light)
    places = [(np.mod(a, p or np.inf) / (p or last) * n).astype(int) for a, p, last, n in
              zip(at[[0, 2, 3]], (0, 0, np.pi), (1, np.pi / 2, 0), MERL_SHAPE)]  # fmt: skip
    nearest = table.values[places[0], 0, places[1], places[2]]
    theta, phi = np.radians(np.arange(0, 91, 5.0)), np.radians(np.arange(0, 360, 5.0))
    nodes = (theta, np.zeros(1), theta, phi)
    grid = np.meshgrid(*nodes, indexing="ij")
    values = lookup(table, direction_of(grid[0], grid[1]).reshape(-1, 3), direction_of(grid[2], grid[3]).reshape(-1, 3))
    coarse = lookup(BrdfTable("difference", nodes, values.reshape(*grid[0].shape, 3)), view, light)
    errors = [np.sqrt(((seen - right) ** 2).mean()) / scale for seen in (linear, nearest, coarse)]
    assert errors[0] < 0.002
    assert 0.02 < errors[1] < 0.04
    assert errors[1] < errors[2] < 0.08


def test_rulers_find_every_interval() -> None:
    rng = np.random.default_rng(4)
    for nodes, period in (
        (np.radians([0.0, 10, 20, 90]), 0.0),
        (np.radians([5.0, 5.2, 44, 44.3, 80]), 0.0),
        (np.radians([-170.0, -20, 3, 4.5, 111]), 2 * np.pi),
        (np.radians([40.0]), 2 * np.pi),
    ):
        bins, per_unit = ruler(nodes, period)
        first, length = nodes[0], period or nodes[-1] - nodes[0]
        along = rng.uniform(0, length, 2000)
        low, slope, middle, after = bins[(along * per_unit).astype(int)].T
        before = along < middle
        number = np.where(before, low, low + 1)
        share = np.where(before, 1 - (middle - along) * slope, (along - middle) * after)
        right, _, wanted = between(nodes, period, first + along)
        assert (number == right).all()
        np.testing.assert_allclose(share, wanted, atol=1e-9)


def test_nodes_too_close_for_a_ruler_are_refused() -> None:
    with pytest.raises(LimitError, match="degrees apart"):
        ruler(np.radians([0.0, 10, 10.005, 90]), 0.0)


def test_tiles_hold_every_value_in_its_place() -> None:
    table = Validation(azimuths="both").table()
    texels, said = plane(table, np.float32), table_uniforms(table)
    a, b, rows, columns, _ = table.values.shape
    for o, p in ((0, 0), (3, 7), (a - 1, b - 1)):
        down, across = divmod(o * b + p, said["table_across"])
        tile = texels[down * rows : (down + 1) * rows, across * columns : (across + 1) * columns, :3]
        assert np.array_equal(tile, table.values[o, p].astype(np.float32))
    assert PERIODS["half"][3] == np.pi


def test_eight_values_are_as_good_as_sixteen_without_a_grain() -> None:
    """Equal where the view has a node's azimuth; else a quarter of the second difference at most (errata 003-4)."""
    rng = np.random.default_rng(6)
    theta, phi = np.radians([0.0, 40, 85]), np.arange(12) * (np.pi / 6)
    values = rng.random((3, 1, 3, 12, 3))
    values[0], values[:, :, 0] = values[0, 0, 0, 0], values[0, 0, 0, 0]
    three = BrdfTable("difference", (theta, np.zeros(1), theta, phi), values)
    turned = np.stack([np.roll(values[:, 0], number, axis=2) for number in range(12)], axis=1)
    four = BrdfTable("angles", (theta, phi, theta, phi), turned)
    light, low = random_directions(500, 7), rng.uniform(0, 1.4, 500)
    at_nodes = direction_of(low, phi[rng.integers(0, 12, 500)])
    np.testing.assert_allclose(lookup(three, at_nodes, light), lookup(four, at_nodes, light), atol=1e-12)
    between_nodes = direction_of(low, rng.uniform(0, 2 * np.pi, 500))
    second = np.abs(np.roll(values, 1, axis=3) - 2 * values + np.roll(values, -1, axis=3)).max()
    off = np.abs(lookup(three, between_nodes, light) - lookup(four, between_nodes, light)).max()
    assert 0.02 < off <= second / 4 + 1e-12


@pytest.mark.parametrize("source", [Validation(), Validation(azimuths="both"), Satin(), Metal()], ids=repr)
def test_the_reference_reads_tables_alike_by_code_of_its_own(source: Validation | Satin | Metal) -> None:
    table = source.table()
    view, light = random_directions(500, 8), random_directions(500, 9)
    other = reflected(Measured(table.coordinates, table.nodes, table.values), view, light)
    np.testing.assert_allclose(lookup(table, view, light), other, rtol=1e-6, atol=1e-9)


def test_a_file_that_no_texture_holds_is_refused_where_it_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("UMBRAGE_CACHE", str(tmp_path))
    monkeypatch.setattr(resident, "SIDE", 40)
    theta, phi = np.linspace(0, 90, 9), np.arange(0, 360, 15.0)
    np.savez(tmp_path / "own.npz", brdf=np.ones((9, 9, 24, 3)), theta_o=theta, theta_l=theta, delta_phi=phi)
    digest = AssetStore().put((tmp_path / "own.npz").read_bytes(), "brdf", "own.npz")
    with pytest.raises(LimitError, match="view directions") as refused:
        File(asset=f"asset:{digest}").table()
    assert refused.value.field == "material.asset"
    monkeypatch.undo()
    monkeypatch.setenv("UMBRAGE_CACHE", str(tmp_path))
    assert File(asset=f"asset:{digest}").table().values.shape == (9, 1, 9, 24, 3)
