"""The shell's tetrahedra and conflicts as a quantity, at its doors."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

from renderer.core.errors import AssetError
from renderer.study import measure as door
from server import cli

MUSHROOM = {"surface": {"kind": "mushroom", "around": 16, "along": 20}}


def test_conflicts_are_counted_and_removed() -> None:
    kept = door.measure("shell", {**MUSHROOM, "extrusion": {"thickness": 0.25}})
    loose = door.measure("shell", {**MUSHROOM, "extrusion": {"thickness": 0.25, "clamp": False}})
    assert len(kept.arrays["overlaps"]) == len(kept.arrays["inverted"]) == 0
    np.testing.assert_array_equal(kept.arrays["overlaps_before"], loose.arrays["overlaps"])
    assert len(loose.arrays["overlaps"]) > 10
    assert kept.arrays["volumes"].min() > 0 > loose.arrays["volumes"].min()
    assert any("shorter offsets" in note for note in kept.meta["notes"])
    assert "planes" not in kept.arrays
    assert door.measure("shell", {**MUSHROOM, "cells": True}).arrays["planes"].shape == (*kept.arrays["tets"].shape, 4)


def test_a_mesh_of_ones_own_at_the_command_line(tmp_path: Path) -> None:
    """A box of 1 x 2 x 3 m: each corner stands out along the diagonal, so the shell is a larger box without the box."""
    path, out = tmp_path / "box.ply", tmp_path / "shell.json"
    trimesh.creation.box((1, 2, 3)).export(path)
    asked = ["--mesh", str(path), "--extrusion", json.dumps({"thickness": 0.1 * 3**0.5})]
    assert cli.main(["measure", "shell", *asked, "-o", str(out)]) == 0
    found = json.loads(out.read_text())
    assert sum(found["volumes"]) == pytest.approx(1.2 * 2.2 * 3.2 - 6, rel=1e-6)
    assert len(found["tets"]) == 36
    assert "tetrahedra: 36" in found["meta"]["notes"]


def test_what_cannot_be_read_is_named(tmp_path: Path) -> None:
    (tmp_path / "no.obj").write_text("nothing")
    with pytest.raises(AssetError) as caught:
        door.measure("shell", {}, {"mesh": tmp_path / "no.obj"})
    assert caught.value.field == "mesh"
