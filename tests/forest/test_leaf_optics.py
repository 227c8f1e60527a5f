"""Leaves of the built-in species: their colours, and how far lobes are from what they send."""

from __future__ import annotations

import importlib.util
import json

import numpy as np
import pytest

from renderer.core.errors import InputError
from renderer.forest import leaf_optics
from renderer.forest.lobe import FITS
from renderer.world.species import species
from renderer.world.tree import Tree, leaves

KEPT = json.loads(FITS.read_text())["species"]


def test_white_is_white_and_a_leaf_is_green() -> None:
    assert leaf_optics.linear_rgb(np.full(301, 0.3)) == pytest.approx([0.3] * 3)
    green = leaf_optics.linear_rgb(np.exp(-(((leaf_optics.WAVELENGTHS - 550) / 30.0) ** 2)))
    assert green[1] > max(green[0], green[2])


def test_leaves_all_alike_agree_and_opposite_ones_do_not() -> None:
    base, along = np.zeros((2, 3)), np.array([[0.2, 0, 0], [0.2, 0, 0.0]])
    for sign, agreement in ((1, 1.0), (-1, 0.0)):
        vertices, faces = leaves(base, along, np.array([[0, 0, 1.0], [0, 0, sign]]), 0.1)
        tree = Tree(vertices, faces, np.zeros((4, 3)), np.zeros(4, bool))
        assert leaf_optics.agreement(tree) == pytest.approx(agreement, abs=1e-9)


@pytest.mark.parametrize("name", leaf_optics.LEAVES)
def test_a_fitted_lobe_is_nearer_than_the_thesis_and_lambert(name: str) -> None:
    kept = KEPT[name]
    assert kept["residuals"]["fitted"] < 0.25
    assert kept["residuals"]["fitted"] < 0.5 * min(kept["residuals"]["thesis"], kept["residuals"]["lambert"])
    assert kept["agreement"] == pytest.approx(leaf_optics.agreement(species()[name].sample(1)), abs=1e-3)
    total = np.array(kept["reflectance"]) + np.array(kept["transmittance"])
    assert (total < 0.4).all(), "a leaf absorbs most of the light that one sees by"


def test_the_kept_leaves_are_prospects() -> None:
    if importlib.util.find_spec("prosail") is None:
        with pytest.raises(InputError, match="prosail"):
            leaf_optics.leaf_colours("birch")
        return
    reflectance, transmittance = leaf_optics.leaf_colours("birch")
    assert reflectance == pytest.approx(KEPT["birch"]["reflectance"], abs=1e-4)
    assert transmittance == pytest.approx(KEPT["birch"]["transmittance"], abs=1e-4)
