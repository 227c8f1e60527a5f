"""Files of one's own on the command line: checked, kept, listed, and named in the place of an asset."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from renderer.core.cache import AssetStore
from renderer.core.errors import InputError
from renderer.core.registry import phenomenon
from server import cli
from server.cli_asset import IS_ASSET, asset_fields, kept_files

SCHEMA = phenomenon("forest").state.model_json_schema()


@pytest.fixture
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> AssetStore:
    monkeypatch.setenv("UMBRAGE_CACHE", str(tmp_path / "cache"))
    return AssetStore()


@pytest.fixture
def hill(tmp_path: Path) -> Path:
    path = tmp_path / "hill.npz"
    np.savez(path, elevation=np.arange(12.0).reshape(3, 4), cell_size=(20.0, 20.0))
    return path


def test_a_file_is_checked_kept_and_listed(store: AssetStore, hill: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["asset", str(hill)]) == 0
    shown = capsys.readouterr().out.splitlines()
    assert IS_ASSET.fullmatch(shown[-1]), "the last line serves $( )"
    assert shown[0].startswith("hill.npz: terrain, kept until 20")
    assert "  rows: 3" in shown
    assert store.get(shown[-1].removeprefix("asset:")).path.read_bytes() == hill.read_bytes()
    assert cli.main(["asset"]) == 0
    assert shown[-1] in capsys.readouterr().out
    assert cli.main(["asset", "--json"]) == 0
    (entry,) = json.loads(capsys.readouterr().out)
    assert (entry["asset"], entry["name"]) == (shown[-1], "hill.npz")


@pytest.mark.usefixtures("store")
def test_a_bad_file_is_refused_in_words(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "x.txt").write_text("no picture")
    for words, message in (
        (["asset", str(tmp_path / "no.npz")], "there is no file"),
        (["asset", str(tmp_path / "x.txt")], "is of no known kind"),
        (["asset", str(tmp_path / "x.txt"), "--reading", "holes"], "FIELD=VALUE"),
    ):
        assert cli.main(words) == 2
        assert message in capsys.readouterr().err


def test_the_fields_that_take_files_are_found() -> None:
    assert asset_fields(SCHEMA) >= {"asset", "mesh", "density_map", "species_map", "canopy_model"}
    assert not asset_fields(SCHEMA) & {"reading", "seed", "east"}


def test_a_file_name_becomes_its_asset(store: AssetStore, hill: Path, tmp_path: Path) -> None:
    sets = {"terrain.kind": "asset", "terrain.asset": str(hill), "sun.elevation": 12}
    made = kept_files(sets, SCHEMA, store)
    assert IS_ASSET.fullmatch(made["terrain.asset"])
    assert {**made, "terrain.asset": str(hill)} == sets
    assert kept_files(made, SCHEMA, store) == made, "an asset stays one"
    with pytest.raises(InputError, match="neither a file nor an asset") as refused:
        kept_files({"cover.density_map": "no.png"}, SCHEMA, store)
    assert refused.value.field == "cover.density_map"


def test_what_is_said_beside_a_file_counts_when_it_is_checked(store: AssetStore, tmp_path: Path) -> None:
    path = tmp_path / "holed.npz"
    np.savez(path, elevation=np.array([[1.0, np.nan], [2.0, 3.0]]), cell_size=(20.0, 20.0))
    with pytest.raises(InputError, match="holes") as refused:
        kept_files({"cover.canopy_model": str(path)}, SCHEMA, store)
    assert refused.value.field == "cover.canopy_model"
    said = {"cover.canopy_model": str(path), "cover.canopy_reading.holes": "fill"}
    assert IS_ASSET.fullmatch(kept_files(said, SCHEMA, store)["cover.canopy_model"])
