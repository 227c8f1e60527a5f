"""What leaves of the built-in species reflect and let through, and how their lobes fit: `umbrage leaves fit`.

Leaves by PROSPECT-D (Féret, Gitelson, Noble & Jacquemoud 2017), of which the package `prosail` has the code and the
spectra; it is needed for this command only, and what it gave is kept in `lobe_fits.json`.
"""

from __future__ import annotations

import importlib
import importlib.util
from typing import Any

import numpy as np
from numpy.typing import NDArray

from renderer.core.errors import InputError
from renderer.forest.lobe import THESIS, coefficients_of, fit_leaves, leaves_reflect, lobe, pairs, relative_residual
from renderer.forest.world_scale import VOXEL
from renderer.world.species import species
from renderer.world.tree import Tree

Floats = NDArray[np.float64]

LEAVES: dict[str, dict[str, float]] = {
    "broadleaf": {"n": 1.6, "cab": 45, "car": 10, "ant": 1.0, "cbrown": 0, "cw": 0.012, "cm": 0.007},
    "conifer": {"n": 2.2, "cab": 55, "car": 11, "ant": 1.0, "cbrown": 0.05, "cw": 0.030, "cm": 0.020},
    "birch": {"n": 1.4, "cab": 32, "car": 8, "ant": 0.5, "cbrown": 0, "cw": 0.010, "cm": 0.005},
}
"""Structure, pigments [ug cm-2], brown matter, water and dry matter [g cm-2] of an oak's, a spruce's and a birch's
leaf: values typical of each within the ranges of LOPEX93 (Hosgood et al. 1995) and ANGERS (Féret et al. 2008), of no
one tree."""

WAVELENGTHS = np.arange(400, 701)

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def linear_rgb(spectrum: Floats) -> Floats:
    """Linear sRGB of a reflectance at `WAVELENGTHS`, white for 1 everywhere; blue below 0 is cut off.

    Source: Wyman, Sloan & Shirley 2013, JCGT 2(2), equation 4, for the observer of CIE 1931; IEC 61966-2-1.
    """

    def bell(middle: float, below: float, above: float) -> Floats:
        t = WAVELENGTHS - middle
        return np.exp(-0.5 * (t * np.where(t < 0, below, above)) ** 2)

    x = 0.362 * bell(442.0, 0.0624, 0.0374) + 1.056 * bell(599.8, 0.0264, 0.0323) - 0.065 * bell(501.1, 0.0490, 0.0382)
    y = 0.821 * bell(568.8, 0.0213, 0.0247) + 0.286 * bell(530.9, 0.0613, 0.0322)
    z = 1.217 * bell(437.0, 0.0845, 0.0278) + 0.681 * bell(459.0, 0.0385, 0.0725)
    to_rgb = np.array([[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]])
    weights = to_rgb @ np.stack([x, y, z])
    return np.maximum(weights @ spectrum / weights.sum(axis=1), 0.0)


def leaf_colours(name: str) -> tuple[Floats, Floats]:
    """Reflectance and transmittance of a species' leaf in linear sRGB, by PROSPECT-D.

    Raises:
        InputError: `prosail` is not installed.
    """
    if importlib.util.find_spec("prosail") is None:
        raise InputError("prosail", "is not installed", "pip install 'umbrage[leaves]'")
    prosail = importlib.import_module("prosail")
    given = dict(LEAVES[name])
    n, cab, car, cbrown, cw, cm = (given.pop(key) for key in ("n", "cab", "car", "cbrown", "cw", "cm"))
    _, reflected, passed = prosail.run_prospect(n, cab, car, cbrown, cw, cm, prospect_version="D", **given)
    visible = slice(0, len(WAVELENGTHS))
    return linear_rgb(np.asarray(reflected)[visible]), linear_rgb(np.asarray(passed)[visible])


def agreement(tree: Tree) -> float:
    """How far the leaves of a voxel agree: length of the mean of their normals, over all leaf area of a tree."""
    corners = tree.vertices[tree.faces[~tree.wood]]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    cells = np.unique(np.floor(corners.mean(axis=1) / VOXEL).astype(int), axis=0, return_inverse=True)[1].ravel()
    sums = np.stack([np.bincount(cells, across[:, axis]) for axis in range(3)], axis=1)
    return float(np.linalg.norm(sums, axis=1).sum() / np.linalg.norm(across, axis=1).sum())


def fitted_species(name: str) -> dict[str, Any]:
    """One species' leaf, and how far lobes are from what a voxel of its leaves sends: relative residuals.

    `fitted` is the lobe for its agreement; `thesis` the thesis' coefficients under the best gain; `lambert` a cosine.
    """
    reflectance, transmittance = leaf_colours(name)
    kappa = agreement(species()[name].sample(1))
    lit, seen, cosine = pairs()
    share = float(transmittance @ LUMINANCE) / float(reflectance @ LUMINANCE)

    def both(reflected: Any) -> Floats:
        """Sun in front and, as much as comes through, behind."""
        result: Floats = reflected(lit, seen, cosine) + share * reflected(-lit, seen, -cosine)
        return result

    wanted = both(lambda *at: leaves_reflect(kappa, *at))
    thesis = both(lambda *at: lobe(np.array(THESIS), *at))
    found = {
        "fitted": both(lambda *at: lobe(coefficients_of(np.array(kappa)), *at)),
        "thesis": thesis * float(thesis @ wanted / (thesis @ thesis)),
        "lambert": np.maximum(lit, 0),
    }
    return {
        "title": species()[name].title,
        "prospect": LEAVES[name],
        "reflectance": np.round(reflectance, 4).tolist(),
        "transmittance": np.round(transmittance, 4).tolist(),
        "agreement": round(kappa, 3),
        "residuals": {key: round(relative_residual(values, wanted), 4) for key, values in found.items()},
    }


def fitted_lobes() -> list[dict[str, Any]]:
    """Lobes of leaves by their agreement, with each fit's relative residual."""
    results = fit_leaves()
    return [
        {
            "kappa": round(float(kappa), 6),
            "coefficients": [round(float(value), 5) for value in one.x],
            "residual": round(one.residual, 5),
            "annealed": one.annealed,
        }
        for kappa, one in zip(np.linspace(0, 1, len(results)), results, strict=True)
    ]
