"""Where a shell stands: directions, thickness by noise, map and paint, and the bake with its report."""

from __future__ import annotations

import io
import math

import numpy as np
import pytest

from renderer.core.cache import AssetStore
from renderer.core.errors import AssetError
from renderer.core.params import bake_arguments
from renderer.core.technique import Bake
from renderer.shells.base_mesh import BaseMesh, from_corners
from renderer.shells.extrusion import (
    Dab,
    EvenThickness,
    Extrusion,
    MappedThickness,
    NoisyThickness,
    extrude,
    lengths,
    noise,
)
from renderer.shells.shell import build_shell
from renderer.shells.shell_bake import (
    bake_shell,
    conflicting,
    pinched_vertices,
    shell_bake,
    shell_facts,
    shell_of,
    shell_words,
)
from renderer.shells.surfaces import Mushroom, Plane, Sphere, bake_surface
from renderer.world.mesh_normals import vertex_normals
from tests.shells.meshes import hourglass, smeared


def test_offsets_follow_the_direction_asked_for() -> None:
    ball = Sphere().mesh()
    along = extrude(ball, Extrusion(thickness=0.1)).offset
    np.testing.assert_allclose(along, 0.1 * vertex_normals(ball.vertices, ball.faces))
    flat = Plane().mesh()
    upwards = extrude(flat, Extrusion(thickness=0.1, direction="up")).offset
    np.testing.assert_allclose(upwards, np.tile((0, 0, 0.1), (25, 1)), atol=1e-15)
    east = extrude(flat, Extrusion(thickness=0.2, direction="fixed", azimuth=90, elevation=30)).offset
    np.testing.assert_allclose(east, np.tile((0.2 * math.cos(math.pi / 6), 0, 0.1), (25, 1)), atol=1e-15)


def test_upwards_a_ball_has_no_shell_below() -> None:
    """Displaced upwards, prisms of the lower half lie at their triangles' backs, however short: that is told."""
    ball = Sphere().mesh()
    found = extrude(ball, Extrusion(thickness=0.05, direction="up")).clamped
    low = ball.vertices[ball.faces].mean(axis=1)[:, 2] < -0.06
    assert np.isin(np.flatnonzero(low), found.left.inverted).all()
    high = ball.vertices[ball.faces].mean(axis=1)[:, 2] > 0.1
    assert not np.isin(np.flatnonzero(high), found.left.inverted).any()


def test_noise_thins_by_its_amount() -> None:
    ball = Sphere(divisions=20).mesh()
    length = lengths(ball, Extrusion(thickness=0.1, relief=NoisyThickness(amount=0.6, size=0.4, seed=3)))
    assert 0.04 - 1e-12 <= length.min() < 0.045
    assert 0.09 < length.max() <= 0.1
    assert length.mean() == pytest.approx(0.07, abs=0.006)
    same = lengths(ball, Extrusion(thickness=0.1, relief=NoisyThickness(amount=0.6, size=0.4, seed=4)))
    assert abs(same - length).max() > 0.01
    steps = abs(np.diff(noise(np.linspace((0, 0, 0), (0.02, 0, 0), 20), 0.4, 3)))
    assert steps.max() < 0.02, "smooth"


def stored(values: np.ndarray) -> str:
    file = io.BytesIO()
    np.savez(file, thickness=values)
    return "asset:" + AssetStore().put(file.getvalue(), "map", "thickness.npz")


def test_a_map_is_read_at_the_texture_coordinates() -> None:
    """Columns along u, rows downwards against v; beyond the edge it repeats, as the texture does."""
    ramp = (np.arange(8) + 0.5)[None, :] / 8 + np.zeros((8, 1))
    relief = MappedThickness(asset=stored(ramp), thinnest=0.2)
    flat = Plane(divisions=8).mesh()
    share = lengths(flat, Extrusion(thickness=1, relief=relief))
    inner = abs(flat.vertices[:, 0]) < 0.8
    u = (flat.vertices[:, 0] + 1) / 2
    np.testing.assert_allclose(share[inner], 0.2 + 0.8 * u[inner], atol=1e-12)
    np.testing.assert_allclose(share[u == 0], share[u == 1])
    high = lengths(flat, Extrusion(thickness=1, relief=MappedThickness(asset=stored(ramp.T[::-1]), thinnest=0.2)))
    v = (flat.vertices[:, 1] + 1) / 2
    inner = abs(flat.vertices[:, 1]) < 0.8
    np.testing.assert_allclose(high[inner], 0.2 + 0.8 * v[inner], atol=1e-12)


def test_a_map_that_cannot_be_used_is_named() -> None:
    with pytest.raises(AssetError) as caught:
        extrude(Plane().mesh(), Extrusion(relief=MappedThickness(asset="asset:" + "1" * 64)))
    assert caught.value.field == "extrusion.relief.asset"


def test_paint_changes_the_thickness_around_its_place() -> None:
    flat = Plane(divisions=16).mesh()
    dabs = (Dab(at=(0.5, 0, 0), radius=0.4, factor=0.25), Dab(at=(-0.5, 0, 0), radius=0.4, factor=2.0))
    length = lengths(flat, Extrusion(thickness=0.1, paint=dabs))
    at = {tuple(np.round(place, 3)): value for place, value in zip(flat.vertices, length)}
    assert at[0.5, 0, 0] == pytest.approx(0.025)
    assert at[-0.5, 0, 0] == pytest.approx(0.2)
    assert at[0, 0, 0] == at[0.5, 0.5, 0] == pytest.approx(0.1)


def test_the_bake_gives_the_shell_and_its_report() -> None:
    surface = Mushroom(around=16, along=20)
    extrusion = Extrusion(thickness=0.25)
    base = bake_surface(bake_arguments(surface), {}, lambda *_: None)
    bake = shell_bake(extrusion, Bake("surface", bake_surface, bake_arguments(surface)))
    arrays = bake.function(bake.arguments, {"surface": base}, lambda *_: None)
    mesh = surface.mesh()
    direct = build_shell(mesh, extrude(mesh, extrusion).offset)
    for name in ("positions", "planes", "to_texture", "neighbour"):
        np.testing.assert_array_equal(getattr(shell_of(arrays), name), getattr(direct, name))
    facts = shell_facts(arrays)
    assert facts["tetrahedra"] == 3 * facts["triangles"] == 3 * len(mesh.faces)
    assert facts["inverted"] == facts["overlaps"] == len(conflicting(arrays)) == 0
    assert facts["overlaps_before"] > 10
    assert 0 < facts["clamped_vertices"] < facts["vertices"] / 2
    assert facts["volume"] == pytest.approx(direct.volumes.sum())
    assert facts["bytes"] == direct.nbytes
    assert len(shell_words(facts)) == 1
    assert "shorter offsets" in shell_words(facts)[0]
    loose = bake_shell(bake_arguments(Extrusion(thickness=0.25, clamp=False)), {"surface": base}, lambda *_: None)
    told = shell_facts(loose)
    assert told["overlaps"] == facts["overlaps_before"]
    assert told["clamped_vertices"] == 0
    np.testing.assert_array_equal(conflicting(loose), np.unique(np.append(loose["inverted"], loose["overlaps"])))


def test_flat_texture_coordinates_are_told() -> None:
    mesh = smeared()
    base = {"vertices": mesh.vertices, "faces": mesh.faces, "corner_uv": mesh.corner_uv, "notes": np.array([], np.str_)}
    arguments = bake_arguments(Extrusion(relief=EvenThickness()))
    facts = shell_facts(bake_shell(arguments, {"surface": base}, lambda *_: None))
    assert shell_words(facts) == ["16 triangles have texture coordinates without area"]


def test_a_pinched_surface_is_told() -> None:
    def pinched(mesh: BaseMesh) -> int:
        return pinched_vertices(build_shell(mesh, 0.01 * vertex_normals(mesh.vertices, mesh.faces)))

    assert pinched(hourglass()) == 1
    assert pinched(Sphere(divisions=3).mesh()) == pinched(Plane().mesh()) == 0


def test_any_triangles_give_a_shell_in_finite_numbers() -> None:
    """Soups of triangles, with corners that fall together, slivers and flat texture coordinates; a prism is sound or
    told."""
    rng = np.random.default_rng(8)
    for number in range(12):
        places = rng.normal(size=(20, 3)) * ((1, 1, 1), (1, 1, 0), (1, 1e-9, 1e-9))[number % 3]
        uv = rng.normal(size=(40, 3, 2)) * (rng.random((40, 1, 1)) > 0.2)
        mesh = from_corners(places[rng.integers(0, 20, (40, 3))], uv, tolerance=1e-9 * (number % 2))
        found = extrude(mesh, Extrusion(thickness=(0.05, 3.0)[number % 2], relief=NoisyThickness()))
        shell = build_shell(mesh, found.offset)
        for array in (shell.planes, shell.to_texture, shell.volumes):
            assert np.isfinite(array).all()
        unsound = np.flatnonzero((shell.volumes.reshape(-1, 3) <= 0).any(axis=1))
        assert np.isin(unsound, found.clamped.left.inverted).all()
