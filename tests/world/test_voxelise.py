"""The voxeliser against closed forms, and against Embree rays along the same sub-rays."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from trimesh.ray.ray_pyembree import RayMeshIntersector

from renderer.core.errors import AssetError
from renderer.world.voxelise import SUB, Grid, voxelise

SHEARED = 0.5 * np.array([[1, 0, 0], [0.5, np.sqrt(0.75), 0], [0, 0, 1]])


def box(low: tuple[float, ...], high: tuple[float, ...]) -> trimesh.Trimesh:
    return trimesh.creation.box(bounds=[low, high])


def run(mesh: trimesh.Trimesh, grid: Grid, **options: bool):
    return voxelise(mesh.vertices, mesh.faces, np.full((len(mesh.faces), 3), (0.2, 0.4, 0.6)), grid, **options)


def embree_mask(mesh: trimesh.Trimesh, grid: Grid) -> np.ndarray:
    """The voxeliser's masks from ray casts alone: every hit of every sub-ray, floored to its voxel."""
    rays = RayMeshIntersector(mesh)
    mask = np.zeros((3, *grid.shape[::-1]), np.uint16)
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        m, n = (
            a.ravel()
            for a in np.meshgrid(np.arange(grid.shape[u] * SUB), np.arange(grid.shape[v] * SUB), indexing="ij")
        )
        start = np.zeros((len(m), 3))
        start[:, axis], start[:, u], start[:, v] = -3.0, (m + 0.5) / SUB, (n + 0.5) / SUB
        direction = np.broadcast_to(grid.axes[axis] / np.linalg.norm(grid.axes[axis]), start.shape)
        place, ray, _ = rays.intersects_location(start @ grid.axes + grid.origin, direction, multiple_hits=True)
        cell = np.floor(grid.to_index(place)).astype(int)
        cell[:, u], cell[:, v] = m[ray] // SUB, n[ray] // SUB
        kept = ((cell >= 0) & (cell < grid.shape)).all(axis=1)
        bits = (1 << (m[ray] % SUB + SUB * (n[ray] % SUB))).astype(np.uint16)
        np.bitwise_or.at(mask[axis], (cell[kept, 2], cell[kept, 1], cell[kept, 0]), bits[kept])
    return mask


def disagreement(a: np.ndarray, b: np.ndarray) -> float:
    """Share of the set bits that only one of two masks has."""
    return float(np.bitwise_count(a ^ b).sum() / np.bitwise_count(a | b).sum())


def test_a_box_of_whole_voxels_has_opaque_faces_and_its_own_normals():
    voxels = run(box((1.0, 1.0, 1.0), (3.5, 3.0, 2.5)), Grid(np.zeros(3), 0.5 * np.eye(3), (8, 8, 8)))
    # The face at z = 1 lies on the boundary and belongs to the voxel above it; along z it stops all 16 sub-rays there.
    assert (voxels.mask[2, 2, 2:6, 2:7] == 0xFFFF).all()
    assert voxels.mask[2, 3].max() == 0
    np.testing.assert_allclose(voxels.normal[2, 3, 4] / np.linalg.norm(voxels.normal[2, 3, 4]), [0, 0, -1], atol=1e-6)
    np.testing.assert_allclose(voxels.mean_attributes()[2, 3, 4], [0.2, 0.4, 0.6], atol=1e-6)
    assert voxels.opacity()[2, 3, 4] == pytest.approx(1 / 3)
    assert voxels.area.sum() == pytest.approx(2 * (2.5 * 2 + 2.5 * 1.5 + 2 * 1.5), rel=1e-5)


@pytest.mark.parametrize("axes", [0.5 * np.eye(3), SHEARED])
def test_a_sphere_has_the_right_outline_area_and_no_net_normal(axes):
    sphere = trimesh.creation.icosphere(subdivisions=5, radius=3.0)
    grid = Grid(-4.0 * np.ones(3) @ axes * 2 - [0.05, 0.02, 0.03], axes, (16, 16, 16))
    voxels = run(sphere, grid)
    assert voxels.area.sum() == pytest.approx(sphere.area, rel=5e-3)
    assert np.abs(voxels.normal.sum(axis=(0, 1, 2))).max() < 5e-3 * sphere.area
    for axis in range(3):
        columns = np.bitwise_or.reduce(voxels.mask[axis], axis=2 - axis)
        across = np.cross(axes[(axis + 1) % 3], axes[(axis + 2) % 3])
        cell = abs(across @ axes[axis]) / np.linalg.norm(axes[axis]) / SUB**2
        # 3600 sub-rays sample the disc: the outline of a circle costs about one part in its radius to the power 3/2.
        assert np.bitwise_count(columns).sum() * cell == pytest.approx(np.pi * 9, rel=0.01)


@pytest.mark.parametrize("axes", [0.5 * np.eye(3), SHEARED])
def test_embree_stops_the_same_sub_rays(axes):
    rng = np.random.default_rng(11)
    corners = rng.uniform(-1.5, 1.5, (400, 1, 3)) + rng.normal(0, 0.3, (400, 3, 3))
    soup = trimesh.Trimesh(corners.reshape(-1, 3), np.arange(1200).reshape(-1, 3), process=False)
    grid = Grid(-4.0 * np.ones(3) @ axes * 2, axes, (16, 16, 16))
    mine, theirs = run(soup, grid).mask, embree_mask(soup, grid)
    # Embree computes in single precision: rays within a micrometre of an edge or of a voxel's boundary may differ.
    assert disagreement(mine, theirs) < 2e-3
    shifted = np.roll(mine, 1, axis=3)
    assert disagreement(shifted, theirs) > 0.5


def test_opacity_of_a_tilted_sheet_is_its_projection():
    """A plane that leaves the block through its sides stops the share of the sub-rays that its slope gives."""
    normal = np.array([0.2, 0.3, 0.93])
    u = np.cross(normal, [1, 0, 0])
    v = np.cross(normal, u)
    corners = 20 * np.array([-u - v, u - v, u + v, -u + v])
    voxels = voxelise(
        corners, np.array([[0, 1, 2], [0, 2, 3]]), np.ones((2, 1)), Grid(-2 * np.ones(3), np.eye(3), (4, 4, 4))
    )
    for axis in range(3):
        hits = np.bitwise_count(voxels.mask[axis]).sum(axis=2 - axis)
        expected = abs(normal[axis]) / np.abs(normal).max()
        assert hits.max() <= 16
        if axis == 2:
            assert (hits == 16).all()
        else:
            # The sheet leaves the block through its sides: it crosses the share of the sub-rays given by its slope.
            assert hits.mean() / 16 == pytest.approx(expected, rel=0.03)


def test_solid_box_is_full_and_a_periodic_grid_wraps():
    grid = Grid(np.zeros(3), 0.5 * np.eye(3), (8, 8, 8))
    solid = run(box((1.0, 1.0, 1.0), (3.0, 2.5, 3.0)), grid, solid=True)
    assert (solid.opacity()[2:6, 2:5, 2:6] == 1).all()
    assert solid.opacity()[:2].max() == 0
    block = box((-0.6, 0.7, 0.9), (0.8, 1.9, 2.2))
    wrapped = run(block, Grid(np.zeros(3), 0.5 * np.eye(3), (8, 8, 8), (True, False, False)))
    inside = run(block.apply_translation([2.0, 0, 0]), grid)
    assert (np.roll(wrapped.mask, 4, axis=3) == inside.mask).all()


def test_a_solid_that_begins_before_the_grid_fills_it():
    solid = run(box((-5.0, -5.0, -5.0), (9.0, 9.0, 9.0)), Grid(np.zeros(3), 0.5 * np.eye(3), (4, 4, 4)), solid=True)
    assert (solid.opacity() == 1).all()


def test_solid_sphere_has_its_volume_plus_half_a_voxel_of_skin():
    sphere = trimesh.creation.icosphere(subdivisions=4, radius=3.0)
    solid = run(sphere, Grid(-4.0 * np.ones(3), 0.25 * np.eye(3), (32, 32, 32)), solid=True)
    # A sub-ray fills every voxel that it enters inside the mesh: on average half a voxel too much at either end.
    along = np.bitwise_count(solid.mask[2]).sum() / 16 * 0.25**3
    assert along == pytest.approx(sphere.volume + np.pi * 9 * 0.25, rel=0.01)


@pytest.mark.parametrize(
    ("vertices", "faces", "field"),
    [
        (np.zeros((3, 3)), np.zeros((0, 3), int), "mesh"),
        (np.zeros((3, 3)), np.array([[0, 1, 3]]), "mesh.faces"),
        (np.array([[0, 0, 0], [1, 0, 0], [0, np.nan, 0]]), np.array([[0, 1, 2]]), "mesh.vertices"),
    ],
)
def test_bad_meshes_are_refused_by_name(vertices, faces, field):
    with pytest.raises(AssetError) as refusal:
        voxelise(vertices, faces, np.ones((len(faces), 1)), Grid(np.zeros(3), np.eye(3), (2, 2, 2)))
    assert refusal.value.field == field


def test_an_open_mesh_is_not_filled():
    sheet = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    with pytest.raises(AssetError, match="watertight"):
        run(sheet, Grid(np.zeros(3), np.eye(3), (2, 2, 2)), solid=True)
