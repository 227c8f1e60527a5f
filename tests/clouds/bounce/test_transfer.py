"""Transfer matrices as a technique: level ground, relief, bases, bounces, and the shader."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import pytest

from renderer.clouds.basis.haar import HaarBasis
from renderer.clouds.basis.object import ObjectBasis
from renderer.clouds.basis.solid_angle import SolidAngleBasis
from renderer.clouds.bounce.fft import Fft
from renderer.clouds.bounce.transfer import TransferMatrices
from renderer.clouds.first_light import bake_bounce_ground
from renderer.clouds.planet import FlatLand, Layer
from renderer.clouds.radiosity.bases import CELL, GRID, HALF
from renderer.clouds.radiosity.matrices import bake_transfer
from renderer.clouds.radiosity.technique import BasisTechnique
from renderer.clouds.state import CloudsState
from renderer.core.errors import Cancelled, InputError
from renderer.core.technique import Arrays, Bake
from renderer.world.camera import Orbit
from tests.clouds.bounce.conftest import HEIGHT, Shown, maps, middles, uneven

BASES = (ObjectBasis(), SolidAngleBasis(), HaarBasis())
PLACES = (np.arange(GRID) + 0.5) * CELL - HALF
FAR = np.hypot(PLACES[:, None], PLACES[None, :])
VALLEY = np.where(FAR > 3, 0.7, 0.0) * HEIGHT
"""A round plain of radius 3H among highlands 0.7H high."""


LAND = Bake("bounce_ground", bake_bounce_ground, {})
KEPT: dict[str, dict[str, Arrays]] = {}


def baked(
    technique: TransferMatrices, basis: BasisTechnique, ground: Mapping[str, np.ndarray] | None = None, rays: int = 64
) -> dict[str, Arrays]:
    """The bake `transfer`, those of level ground once each."""
    bake = technique.matrix_bake(basis, HEIGHT, None if ground is None else LAND)
    name = str(bake.arguments)
    if ground is None and name in KEPT:
        return KEPT[name]
    inputs = {} if ground is None else {"bounce_ground": dict(ground)}
    found = {"transfer": bake.function({**bake.arguments, "rays": rays}, inputs, lambda share, words: None)}
    if ground is None:
        KEPT[name] = found
    return found


@pytest.mark.parametrize("basis", BASES, ids=lambda basis: basis.kind)
def test_even_planes_give_the_closed_sum(basis: BasisTechnique) -> None:
    for technique in (TransferMatrices(), TransferMatrices(gather=False), TransferMatrices(method="bounces")):
        found = technique.solve(maps(), basis, baked(technique, basis)).added
        np.testing.assert_allclose(found.ground, 200 * 0.18 / 0.82, rtol=2e-3)
        np.testing.assert_allclose(found.cloud, 60 / 0.82, rtol=2e-3)


@pytest.mark.parametrize("basis", BASES, ids=lambda basis: basis.kind)
def test_level_ground_is_near_the_exact_kernel(basis: BasisTechnique) -> None:
    """The final gather leaves to the basis the light of the fourth half-bounce on."""
    exact = Fft(bounces=12).solve(uneven(), None, {}).added
    technique = TransferMatrices()
    found = technique.solve(uneven(), basis, baked(technique, basis)).added
    inner = (slice(16, 48),) * 2
    for ours, theirs in ((found.ground, exact.ground), (found.cloud, exact.cloud)):
        assert np.sqrt(np.mean((ours - theirs)[inner] ** 2)) / theirs[inner].mean() < 0.02
    blocks = TransferMatrices(gather=False).solve(uneven(), basis, baked(technique, basis)).added
    assert np.abs(blocks.ground - exact.ground)[inner].mean() > np.abs(found.ground - exact.ground)[inner].mean()


def test_a_valley_among_bright_slopes_is_brighter_than_level_ground_says() -> None:
    technique, basis = TransferMatrices(), ObjectBasis()
    snow = maps(elevation=VALLEY, albedo=np.full((GRID, GRID, 3), 0.8), reflectance=np.zeros((GRID, GRID)))
    relief = technique.solve(snow, basis, baked(technique, basis, {"elevation": VALLEY, "albedo": snow.albedo}))
    level = technique.solve(snow, basis, baked(technique, basis))
    rim = np.abs(FAR - 2) < 0.6
    assert relief.added.ground[rim].mean() > level.added.ground[rim].mean() + 2, "slopes light each other"
    assert level.added.ground.max() < 1e-3, "level ground under a black cloud has nothing"


def shader_error(shown: Shown, basis: BasisTechnique, gather: bool = False) -> float:
    technique = TransferMatrices(gather=gather)
    solved = technique.solve(uneven(), basis, baked(technique, basis))
    places, (rows, columns) = middles()
    if basis.kind == "object":  # type: ignore[attr-defined]
        keep = (rows % 8 == 4) & (columns % 8 == 4)  # half a cell from the blocks' middles
        places, rows, columns = places[keep] - CELL / 2 * HEIGHT, rows[keep], columns[keep]
    worst = 0.0
    for found, field in zip(
        shown(technique, basis, solved, places), (solved.added.ground, solved.added.cloud), strict=True
    ):
        worst = max(worst, float(np.abs(found - field[rows, columns]).max() / field.mean()))
    return worst


@pytest.mark.parametrize("basis", BASES, ids=lambda basis: basis.kind)
def test_the_shader_evaluates_the_basis(shown: Shown, basis: BasisTechnique) -> None:
    assert shader_error(shown, basis) < 1e-4


def test_the_shader_adds_what_was_gathered(shown: Shown, spoil: Callable) -> None:
    assert shader_error(shown, HaarBasis(), gather=True) < 1e-4
    with spoil("clouds/bounce/transfer.glsl", "textureLod(bounce_ground_map, at * 0.5 + 0.5, 0.0).rgb +", ""):
        assert shader_error(shown, HaarBasis(), gather=True) > 0.1
    with spoil("clouds/bounce/transfer.glsl", "+ basis_cloud(at)", ""):
        assert shader_error(shown, HaarBasis()) > 0.1


def test_the_bake_follows_basis_relief_and_height() -> None:
    technique = TransferMatrices(coefficients=256)
    state = CloudsState(basis=SolidAngleBasis(centre_height=5.0), layer=Layer(base=1000.0))
    (bake,) = technique.bakes(state)
    assert [source.name for source in bake.inputs] == ["bounce_ground"]
    assert [source.name for source in bake.inputs[0].inputs] == ["land"]
    assert bake.arguments["basis"] == "solid_angle"
    assert (bake.arguments["height"], bake.arguments["centre_height"], bake.arguments["coefficients"]) == (1000, 5, 256)
    (level,) = technique.bakes(CloudsState(land=FlatLand()))
    assert level.inputs == ()
    assert level.arguments["height"] == 1, "level ground has one set for every height"
    (far,) = technique.bakes(CloudsState(camera=Orbit(distance=1e5)))
    assert (far.arguments["scale"], far.inputs) == (2, ())


def test_a_wider_square_exchanges_more_within_its_cells() -> None:
    technique, basis = TransferMatrices(), ObjectBasis()
    near, far = (technique.matrix_bake(basis, HEIGHT, scale=scale) for scale in (1.0, 4.0))
    (one, other) = (bake.function(bake.arguments, {}, lambda share, words: None)["from_cloud"] for bake in (near, far))
    assert np.diag(other).mean() > np.diag(one).mean() + 0.15
    np.testing.assert_allclose(other.sum(axis=1), 1, atol=1e-4)


def test_relief_of_another_size_is_refused_and_work_stops() -> None:
    arguments = TransferMatrices().matrix_bake(ObjectBasis(), HEIGHT, LAND).arguments
    with pytest.raises(InputError, match="elevation"):
        bake_transfer(arguments, {"bounce_ground": {"elevation": np.zeros((8, 8)), "albedo": np.zeros((8, 8))}}, print)
    high = {"bounce_ground": {"elevation": 2 * VALLEY, "albedo": 0.3 + 0 * VALLEY}}
    with pytest.raises(InputError, match="base"):
        bake_transfer(arguments, high, lambda share, words: None)

    def stop(share: float, words: str) -> None:
        raise Cancelled("enough")

    with pytest.raises(Cancelled):
        bake_transfer(arguments, {"bounce_ground": {"elevation": VALLEY, "albedo": 0.3 + 0 * VALLEY}}, stop)
