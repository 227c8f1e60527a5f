"""Uploads: recognised by content, opened in a process with nothing to lose, refused in words."""

from __future__ import annotations

import json
import os
import pickle
import struct
import subprocess
import sys
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
import trimesh
from PIL import Image

from renderer.core.cache import AssetStore
from renderer.core.errors import AssetError, InputError, LimitError
from renderer.world import upload
from renderer.world.limits import Limits
from renderer.world.mesh_formats import FORMATS as MESH_FORMATS
from renderer.world.upload import Kind, check_in_worker, recognise
from renderer.world.upload_preview import PREVIEWS

HEIGHTS = np.arange(30, dtype=np.float32).reshape(5, 6)


def npz(path: Path, **arrays: object) -> Path:
    np.savez(path, **arrays)
    return path


@pytest.fixture
def samples(tmp_path: Path) -> dict[str, Path]:
    """One sound file of each kind, none with a name that says what it is."""
    files = {name: tmp_path / f"{name}.dat" for name in ("tiff", "png16", "png8", "jpeg", "glb", "obj", "stl", "npy")}
    Image.fromarray(HEIGHTS).save(files["tiff"], "TIFF")
    Image.fromarray((HEIGHTS * 100).astype(np.uint16)).save(files["png16"], "PNG")
    Image.fromarray(np.zeros((4, 4, 3), dtype=np.uint8)).save(files["png8"], "PNG")
    Image.fromarray(np.zeros((4, 4, 3), dtype=np.uint8)).save(files["jpeg"], "JPEG")
    for kind in ("glb", "obj", "stl"):
        data = trimesh.creation.box().export(file_type=kind)
        files[kind].write_bytes(data.encode() if isinstance(data, str) else data)
    with files["npy"].open("wb") as stream:
        np.save(stream, np.zeros((2, 2, 4), dtype=np.float32))
    files["terrain"] = npz(tmp_path / "a.npz", elevation=HEIGHTS, cell_size=(7.0, 8.0))
    files["volume"] = npz(tmp_path / "b.npz", rgba=np.full((2, 3, 4, 4), 0.5), reference_length=0.5)
    return files


def test_every_kind_is_recognised_by_its_content(samples: dict[str, Path]) -> None:
    expected = {
        "tiff": "terrain",
        "png16": "terrain",
        "png8": "image",
        "jpeg": "image",
        "glb": "mesh",
        "obj": "mesh",
        "stl": "mesh",
        "npy": "image",
        "terrain": "terrain",
        "volume": "volume",
    }
    assert {name: recognise(path, "x.txt") for name, path in samples.items()} == expected


def test_files_of_every_format_that_is_read_can_be_kept(tmp_path: Path) -> None:
    store = AssetStore(tmp_path / "assets")
    for ending in ("glb", "gltf", "obj", "ply", "stl", "off"):
        assert ending in MESH_FORMATS.lower()
        assert store.get(store.put(b"data", "mesh", f"tree.{ending}")).path.suffix == f".{ending}"
    for ending in ("tif", "tiff", "png", "npz", "jpg", "jpeg", "hdr", "exr", "npy"):
        store.put(b"data", "image", f"file.{ending}")


def test_what_a_file_leaves_unsaid_is_checked_with_it(tmp_path: Path) -> None:
    holed = HEIGHTS.copy()
    holed[2, 3] = np.nan
    path = npz(tmp_path / "holed.npz", elevation=holed, cell_size=(7.0, 8.0))
    with pytest.raises(AssetError, match="holes = fill"):
        check_in_worker(path, "terrain")
    assert "1 holes were filled" in check_in_worker(path, "terrain", reading={"holes": "fill"})["notes"]
    with pytest.raises(InputError, match="hole: is not a parameter"):
        check_in_worker(path, "terrain", reading={"hole": "fill"})


def test_every_kind_has_a_preview_and_every_preview_a_kind() -> None:
    assert set(PREVIEWS) == set(get_args(Kind))


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (pickle.dumps({"a": 1}), "pickle"),
        (b"\x1f\x8b" + b"\0" * 50, "gzip"),
        (b"<html>", "no known kind"),
        (b"", "empty"),
    ],
)
def test_kinds_without_a_loader_are_refused_in_words(data: bytes, words: str, tmp_path: Path) -> None:
    path = tmp_path / "x"
    path.write_bytes(data)
    with pytest.raises(AssetError, match=words):
        recognise(path)
    with pytest.raises(AssetError, match=r"kind.*point_cloud"):
        check_in_worker(path, "point_cloud")


def test_archives_of_other_arrays_name_what_they_hold(tmp_path: Path) -> None:
    with pytest.raises(AssetError, match=r"file.*wind.*elevation \(a terrain\)"):
        recognise(npz(tmp_path / "x.npz", wind=HEIGHTS))


def test_previews_say_size_units_and_extent(samples: dict[str, Path]) -> None:
    """Two kinds the whole way through the process, which the others share."""
    land = check_in_worker(samples["terrain"], "terrain")
    assert (land["rows"], land["columns"], land["cell_size"], land["extent"]) == (5, 6, [7, 8], [35, 32])
    assert land["elevation"] == {"lowest": 0, "highest": 29}
    body = check_in_worker(samples["glb"], "mesh")
    assert (body["faces"], body["extent"], body["watertight"]) == (12, pytest.approx([1, 1, 1]), True)
    assert body["texture_coordinates"] is False
    box = PREVIEWS["volume"](samples["volume"], Limits(), {})
    assert (box["voxels"], box["extent"], box["reference_length"]) == ([4, 3, 2], [2, 1.5, 1], 0.5)
    assert PREVIEWS["image"](samples["png8"], Limits(), {})["width"] == 4


def test_what_a_format_cannot_say_is_asked_for(samples: dict[str, Path], tmp_path: Path) -> None:
    assert PREVIEWS["terrain"](samples["png16"], Limits(), {}) == {
        "rows": 5,
        "columns": 6,
        "still_to_say": "cell_size, elevation_low, elevation_high",
    }
    assert PREVIEWS["terrain"](samples["tiff"], Limits(), {})["still_to_say"] == "cell_size"
    said = {"cell_size": (5.0, 5.0), "elevation_high": 100.0}
    assert PREVIEWS["terrain"](samples["png16"], Limits(), said)["extent"] == [25, 20]
    rgba = npz(tmp_path / "c.npz", rgba=np.full((2, 3, 4, 4), 0.5))
    assert PREVIEWS["volume"](rgba, Limits(), {}) == {"voxels": [4, 3, 2], "still_to_say": "reference_length"}


@pytest.mark.parametrize(
    ("kind", "make", "field"),
    [
        ("terrain", lambda p: npz(p, elevation=HEIGHTS[:1, :1], cell_size=1.0), "elevation"),
        ("terrain", lambda p: npz(p, elevation=np.where(HEIGHTS == 7, np.nan, HEIGHTS), cell_size=1.0), "elevation"),
        ("mesh", lambda p: p.write_bytes(b"v 0 0 0\nv 1 0 0\n"), "faces"),
    ],
)
def test_refusals_cross_the_process_with_their_field(kind: str, make, field: str, tmp_path: Path) -> None:
    path = tmp_path / "x.npz"
    make(path)
    with pytest.raises(AssetError) as refusal:
        check_in_worker(path, kind)
    assert refusal.value.field == field
    assert refusal.value.allowed


def test_holes_pass_when_they_are_to_be_filled_and_a_bad_reading_is_named(tmp_path: Path) -> None:
    path = npz(tmp_path / "x.npz", elevation=np.where(HEIGHTS == 7, np.nan, HEIGHTS), cell_size=1.0)
    assert "1 holes were filled" in check_in_worker(path, "terrain", reading={"holes": "fill"})["notes"]
    with pytest.raises(AssetError, match=r"holes"):
        check_in_worker(path, "terrain", reading={"holes": "perhaps"})


def test_limits_cross_the_process_as_limits(samples: dict[str, Path]) -> None:
    with pytest.raises(LimitError, match="elevation"):
        check_in_worker(samples["terrain"], "terrain", Limits(cells=10))
    with pytest.raises(LimitError, match=r"took too long.*0\.01 s"):
        check_in_worker(samples["terrain"], "terrain", Limits(worker_seconds=0.01))


def confined(code: str, **limits: object) -> dict:
    """Run `code` in place of a loader inside the checking process."""
    # A stand-in for the loaders' module keeps each of these processes from importing all of them.
    program = (
        "import sys, types\n"
        f"def trial(path, limits, reading):\n    {code}\n"
        "loaders = types.ModuleType('renderer.world.upload_preview')\n"
        "loaders.PREVIEWS = {'terrain': trial}\n"
        "sys.modules[loaders.__name__] = loaders\n"
        "from renderer.world.upload_worker import main\nmain()\n"
    )
    task = {"path": "/nowhere", "kind": "terrain", "limits": Limits(**limits).model_dump(), "reading": {}}
    done = subprocess.run(
        [sys.executable, "-c", program],
        input=json.dumps(task).encode(),
        capture_output=True,
        timeout=60,
        check=False,
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
    )
    return {"out": json.loads(done.stdout) if done.stdout else None, "code": done.returncode}


def test_a_loader_gone_wild_is_stopped_by_memory_time_and_disk(tmp_path: Path) -> None:
    greedy = confined("import numpy as np; return {'x': float(np.ones(1 << 30).sum())}", worker_bytes=2 << 30)
    assert greedy["out"]["limit"]
    assert "memory" in greedy["out"]["error"]["message"]
    busy = confined("exec('while True: pass')", worker_seconds=0.5)
    assert (busy["out"], busy["code"] < 0) == (None, True)
    target = tmp_path / "loot"
    writing = confined(f"import pathlib; pathlib.Path({str(target)!r}).write_text('x' * 99)")
    assert (writing["out"], writing["code"] != 0) == (None, True)
    assert not target.exists() or target.stat().st_size == 0
    chatty = confined("print('noise'); return {'fine': True}")
    assert chatty["out"] == {"preview": {"fine": True}}


def test_a_process_that_dies_without_words_is_an_error_in_words() -> None:
    with pytest.raises(AssetError, match=r"file.*memory and time"):
        upload._answer(b"", Limits())


def test_200_random_bytes_and_false_headers_are_refused(tmp_path: Path) -> None:
    rng = np.random.Generator(np.random.PCG64(7))
    path = tmp_path / "noise"
    for mark in (b"", b"II*\0", b"\x89PNG\r\n\x1a\n", b"PK\x03\x04", b"glTF", b"ply\n", b"solid "):
        path.write_bytes(mark + rng.bytes(200))
        with pytest.raises(InputError):
            PREVIEWS[recognise(path, "noise.stl")](path, Limits(), {})


def test_truncated_uploads_are_refused_at_every_tenth(samples: dict[str, Path], tmp_path: Path) -> None:
    """Whatever is left of a file, it is refused or, for OBJ which has no end, a smaller mesh."""
    path = tmp_path / "cut"
    for name in ("terrain", "volume", "glb", "stl", "png16", "tiff"):
        data = samples[name].read_bytes()
        for tenth in range(10):
            path.write_bytes(data[: len(data) * tenth // 10])
            with pytest.raises(InputError):
                PREVIEWS[recognise(path)](path, Limits(), {})


def test_a_stranger_with_a_2_gb_claim_is_refused_through_the_process(tmp_path: Path) -> None:
    path = tmp_path / "vast.stl"
    path.write_bytes(b"\0" * 80 + struct.pack("<I", (2 << 30) // 50) + b"\0" * 50)
    kind = recognise(path, "vast.stl")
    with pytest.raises(InputError, match=r"file|faces"):
        check_in_worker(path, kind)
