"""The built-in species: what a tree must be, whichever it is."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from renderer.core.cache import AssetStore
from renderer.core.errors import AssetError, InputError, LimitError
from renderer.forest.nursery import MAX_FACES, OWN_HEIGHT, OWN_REACH, nursery, own_tree
from renderer.world.mesh import Mesh
from renderer.world.species import species
from renderer.world.tree import Tree, leaves, tubes

NAMES = ["birch", "broadleaf", "conifer"]


def normals(tree: Tree) -> np.ndarray:
    a, b, c = (tree.vertices[tree.faces[:, n]] for n in range(3))
    return np.cross(b - a, c - a)


def test_the_folder_holds_the_three_species():
    assert list(species()) == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_a_tree_stands_on_the_ground_in_its_size(name):
    kind = species()[name]
    for seed in range(3):
        tree = kind.sample(seed)
        assert 5_000 <= len(tree.faces) <= 25_000
        assert 0.93 * kind.height[0] <= tree.height <= 1.02 * kind.height[1]
        assert tree.height < 20
        assert tree.vertices[:, 2].min() > -0.05
        foot = tree.vertices[tree.vertices[:, 2] < 0.3]
        assert np.hypot(*foot[:, :2].T).max() < 0.5
        # The crown is what was asked for, twigs and leaves stick out a little; a foot's offset fits in its byte.
        assert tree.crown_radius <= tree.reach <= 1.35 * kind.crown * tree.height
        assert tree.reach < 7.9


@pytest.mark.parametrize("name", NAMES)
def test_height_and_crown_are_parameters(name):
    kind = species()[name]
    small, wide = kind.sample(4, height=8.0), kind.sample(4, height=8.0, crown_radius=3.0)
    assert small.height == pytest.approx(8.0, rel=0.08)
    assert wide.crown_radius > 1.2 * small.crown_radius


@pytest.mark.parametrize("name", NAMES)
def test_a_seed_is_a_tree(name):
    kind = species()[name]
    first, again, other = kind.sample(7), kind.sample(7), kind.sample(8)
    np.testing.assert_array_equal(first.vertices, again.vertices)
    np.testing.assert_array_equal(first.colour, again.colour)
    assert first.vertices.shape != other.vertices.shape or np.abs(first.vertices - other.vertices).max() > 0.1


@pytest.mark.parametrize("name", NAMES)
def test_leaves_face_out_of_the_crown_and_up(name):
    tree = species()[name].sample(2)
    area = normals(tree)[~tree.wood]
    middle = tree.vertices[tree.faces[~tree.wood]].mean(axis=1)
    outward = middle - np.average(middle, axis=0)
    outward[:, 2] = 0
    facing = (area * outward).sum(axis=1)
    assert area[:, 2].sum() > 0.25 * np.linalg.norm(area, axis=1).sum()
    assert (facing > 0).mean() > 0.6
    spoiled = -area
    assert not (spoiled * outward).sum() > 0


@pytest.mark.parametrize("name", NAMES)
def test_leaf_area_and_colour_are_those_of_a_forest(name):
    tree = species()[name].sample(1)
    area = np.linalg.norm(normals(tree), axis=1)[~tree.wood].sum() / 2
    # Over its own disc one crown carries more than a stand's mean leaf area index of 4 to 8 (Breda 2003); spruce most.
    assert 4 < area / (np.pi * tree.crown_radius**2) < 20
    green = tree.colour[~tree.wood].mean(axis=0)
    assert green[1] > green[0] > 0.02
    assert green[1] > green[2] > 0.015
    assert 0.15 < tree.wood.mean() < 0.7
    assert (tree.colour >= 0).all()
    assert (tree.colour <= 1).all()


def test_a_tube_is_a_cylinder_facing_outwards():
    vertices, faces = tubes(np.array([[[0, 0, 0], [0, 0, 1], [0, 0, 2.0]]]), np.full((1, 3), 0.5), 64)
    cylinder = trimesh.Trimesh(vertices, faces)
    assert cylinder.area == pytest.approx(2 * np.pi, rel=1e-3)
    assert ((cylinder.face_normals * cylinder.triangles_center * [1, 1, 0]).sum(axis=1) > 0).all()


def test_a_leaf_has_its_size_and_its_side():
    vertices, faces = leaves(np.zeros((1, 3)), np.array([[0.3, 0, 0]]), np.array([[0, 0, 1.0]]), 0.2)
    leaf = trimesh.Trimesh(vertices, faces, process=False)
    assert leaf.area == pytest.approx(0.03)
    np.testing.assert_allclose(leaf.face_normals, [[0, 0, 1], [0, 0, 1]], atol=1e-12)


def test_placing_turns_clockwise_and_scales_about_the_foot():
    tree = Tree(np.array([[0, 1.0, 2.0]]), np.zeros((0, 3), int), np.zeros((0, 3)), np.zeros(0, bool))
    np.testing.assert_allclose(tree.placed(2, 0.5, np.pi / 2, np.array([10, 20])), [[11, 20, 4]], atol=1e-12)


def cone(height: float, radius: float) -> Mesh:
    shape = trimesh.creation.cone(radius, height)
    shape.apply_translation([30.0, -7.0, 4.0])
    return Mesh(shape.vertices, shape.faces, np.full((len(shape.faces), 3), 0.1))


def test_the_users_tree_is_scaled_and_stood_on_its_foot():
    tree = own_tree(cone(3.0, 1.0))
    assert tree.height == pytest.approx(OWN_HEIGHT)
    assert tree.vertices[:, 2].min() == pytest.approx(0, abs=1e-9)
    assert tree.reach == pytest.approx(OWN_HEIGHT / 3, rel=0.05)
    assert own_tree(cone(3.0, 9.0)).reach == pytest.approx(OWN_REACH, rel=0.01)


def test_an_uploaded_tree_replaces_the_species(tmp_path, monkeypatch):
    monkeypatch.setenv("UMBRAGE_CACHE", str(tmp_path))
    shape = cone(3.0, 1.0)
    data = trimesh.Trimesh(shape.vertices, shape.faces).export(file_type="ply")
    key = AssetStore().put(data, "mesh", "cone.ply")
    meshes, shares, kinds = nursery({"broadleaf": 1.0, "mesh": f"asset:{key}", "seed": 1})
    assert len(meshes) == 1
    assert meshes[0].height == pytest.approx(OWN_HEIGHT)
    assert shares.tolist() == [1.0]
    assert len(kinds) == 1


def test_a_mesh_that_is_no_tree_is_refused_by_name():
    flat = Mesh(np.eye(3) * [1, 1, 0], np.array([[0, 1, 2]]), np.ones((1, 3)))
    with pytest.raises(AssetError, match="flat"):
        own_tree(flat)
    with pytest.raises(LimitError) as refusal:
        own_tree(Mesh(np.eye(3), np.zeros((MAX_FACES + 1, 3), int), np.ones((MAX_FACES + 1, 3))))
    assert refusal.value.field == "canopy.mesh"


def test_a_canopy_without_trees_is_refused():
    with pytest.raises(InputError, match="no species"):
        nursery({"broadleaf": 0.0, "conifer": 0.0, "birch": 0.0, "mesh": "", "seed": 1})
