"""Stands of the reference: which trees a share leaves, and a layer as tall as the place says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from renderer.core.errors import InputError
from renderer.reference.forest import render
from renderer.reference.forest_march import ALL, COLUMNS, march
from renderer.reference.forest_world import ALONE, EVERYWHERE, NOWHERE, RANKS, SOMEWHERE, Scene, prepare
from tests.reference.worlds import CENTRE, flat, grove, looking, unit

ALPHA = 12
NODES = 33
RAMP = 0.004


def ramp(**changes: object):  # type: ignore[no-untyped-def]
    """A slab on level ground, taller to the east."""
    x = (np.arange(NODES) - NODES // 2) * 8.0
    return flat(ALPHA, nodes=NODES, growth=np.broadcast_to(1 + RAMP * x, (NODES, NODES)).copy(), **changes)


@pytest.mark.parametrize(("x", "direction"), [(-60.0, (0, 0, -1)), (40.0, (0.6, 0, -0.8)), (20.0, (-0.5, 0.3, -0.6))])
def test_a_ray_meets_as_much_as_the_stand_is_tall(x: float, direction: tuple[float, ...]) -> None:
    d, start = unit(direction), 40.0
    enter = (start - 20 * (1 + RAMP * x)) / (20 * RAMP * d[0] - d[2])
    exact = -np.log(1 - ALPHA / 255) / 0.625 * (start / -d[2] - enter)
    scene, nothing = prepare(ramp()), np.empty((0, COLUMNS))
    _, s, tau, _ = march(scene, (x, 3.0, start), tuple(d), 0.0, 0.0, 50.0, 0.05, True, ALL, (0.0, 0.0), nothing)
    assert s == pytest.approx(start / -d[2])
    assert tau == pytest.approx(exact, rel=2e-3)


def test_trees_of_a_rank_below_the_share_stand() -> None:
    world = flat(200, ground_albedo=(0.0, 0.0, 0.0))
    for rank in (0, 40, 127):
        anchor = world.anchor.copy()
        anchor[..., 3] = rank + 128  # in wood as in leaves
        for share in (0.0, rank / RANKS, rank / RANKS + 0.004, 1.0):
            there = replace(world, anchor=anchor, presence=np.full((66, 66), share))
            seen = render(there, looking([[3, 1]]), CENTRE).radiance[0, 0, 0]
            assert (seen > 0) == (share > rank / RANKS)


@pytest.mark.parametrize("species", [0, 1, 2, 4])
def test_trees_of_the_species_at_their_foot_stand(species: int) -> None:
    """One pixel of the map, 16 m wide, has a species; elsewhere stands species 3."""
    there = np.full((16, 16), 3, np.uint8)
    there[5, 9] = species  # its middle is 24 m east and 40 m north of the square's
    world = flat(200, nodes=32, ground_albedo=(0.0, 0.0, 0.0), species=there)
    for band, rank in ((0, 5), (1, 5), (2, 20), (3, 31)):
        for foot in (0, 90):  # sixteenths of a metre to the east of a place 4 m inside the pixel's eastern edge
            anchor = world.anchor.copy()
            anchor[..., 0] = 128 + foot
            anchor[..., 3] = 32 * band + rank
            for share in (rank / 32, rank / 32 + 0.004):
                shown = replace(world, anchor=anchor, presence=np.full((66, 66), share))
                seen = render(shown, looking([[28, 40]]), CENTRE).radiance[0, 0, 0]
                at = 3 if foot else species
                assert (seen > 0) == (at in (0, band + 1) and share > rank / 32)


def test_a_finer_share_lies_on_the_same_square() -> None:
    """Shares on the nodes and twice as fine, of a step to the east, agree away from the step."""
    step = np.repeat(np.arange(NODES)[None] > 20, NODES, axis=0).astype(float)
    coarse, fine = (prepare(flat(200, presence=given)) for given in (step, step.repeat(2, axis=0).repeat(2, axis=1)))
    assert fine.share_cell == coarse.share_cell / 2
    sure = np.isin(coarse.presence, (EVERYWHERE, NOWHERE)) & np.isin(fine.presence, (EVERYWHERE, NOWHERE))
    np.testing.assert_array_equal(fine.presence[sure], coarse.presence[sure])
    assert 0.7 < sure.mean() < 1
    assert set(np.unique(coarse.presence[sure])) == {EVERYWHERE, NOWHERE}


def test_cells_that_are_sure_of_their_trees_are_right() -> None:
    """What the march skips asking changes nothing: every anchor asked gives the same picture."""
    rng = np.random.default_rng(2)
    share = rng.permutation(np.repeat([0.0, 0.4, 1.0], 3)).reshape(3, 3)
    world = grove(trees=8, presence=np.kron(share, np.ones((22, 22))))
    anchor = world.anchor.copy()
    anchor[..., 3] = rng.integers(0, RANKS, anchor.shape[1:3])
    world = replace(world, anchor=anchor)
    scene = prepare(world)
    assert {int(kind) for kind in np.unique(scene.presence)} == {0, 1, 2}
    asked = scene._replace(presence=np.full_like(scene.presence, 2))
    nothing, d = np.empty((0, COLUMNS)), tuple(unit((0.3, 0.2, -0.4)))
    met = []
    for x, y in rng.uniform(-120, 120, (200, 2)):
        both = [march(given, (x, y, 50.0), d, 0.0, 0.0, 9.0, 0.2, True, ALL, (0.0, 0.0), nothing)
                for given in (scene, asked)]
        assert both[0] == pytest.approx(both[1])
        met.append(both[0][2])
    assert 0.1 < np.mean(np.array(met) > 0) < 0.9


def test_cells_of_one_species_are_right() -> None:
    """Likewise under a map: the trees that stand alone are found without asking, in an atlas that mixes them."""
    rng = np.random.default_rng(3)
    quarters = np.kron(np.array([[1, 2], [3, 0]], np.uint8), np.ones((4, 4), np.uint8))
    world = grove(trees=8, presence=np.ones((66, 66)), species=quarters)
    anchor = world.anchor.copy()
    anchor[..., 3] = rng.integers(0, RANKS, anchor.shape[1:3])
    scene = prepare(replace(world, anchor=anchor))
    assert {int(kind) for kind in np.unique(scene.presence)} == {EVERYWHERE, SOMEWHERE, ALONE, ALONE + 1, ALONE + 2}

    def depths(given: Scene) -> list[float]:
        nothing, d = np.empty((0, COLUMNS)), tuple(unit((0.03, 0.02, -0.4)))
        return [march(given, (x, y, 50.0), d, 0.0, 0.0, 9.0, 0.2, True, ALL, (0.0, 0.0), nothing)[2]
                for x, y in np.random.default_rng(4).uniform(-120, 120, (300, 2))]

    asked = depths(scene._replace(presence=np.full_like(scene.presence, SOMEWHERE)))
    # the steps begin where the last skip ended, and skips past what does not stand are longer
    assert np.mean(np.abs(np.subtract(depths(scene), asked))) < 0.02 * np.mean(asked)
    mistaken = np.where(scene.presence == ALONE, ALONE + 1, scene.presence)
    assert np.mean(np.abs(np.subtract(depths(scene._replace(presence=mistaken)), asked))) > 0.1 * np.mean(asked)


def test_arrays_that_do_not_fit_are_refused() -> None:
    for changes, field in (({"growth": np.ones((3, 3))}, "growth"), ({"growth": np.zeros((NODES, NODES))}, "growth"),
                           ({"presence": np.ones((3, 4))}, "presence"),
                           ({"species": np.ones((3, 4), np.uint8)}, "species")):
        with pytest.raises(InputError) as refused:
            flat(10, nodes=NODES, **changes)
        assert refused.value.field == field
