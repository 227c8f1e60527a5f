"""Uploaded files come back whole under their hash, within a quota, until they expire."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from renderer.core.cache import AssetStore
from renderer.core.errors import AssetError, LimitError


@pytest.fixture
def store(tmp_path: Path) -> AssetStore:
    return AssetStore(tmp_path, quota_bytes=1000, lifetime_s=100.0)


def test_returns_what_was_put(store: AssetStore) -> None:
    digest = store.put(b"heights", "terrain", "My Valley.TIF")
    asset = store.get(digest)
    assert asset.path.read_bytes() == b"heights"
    assert asset.path.suffix == ".tif"
    assert (asset.kind, asset.name) == ("terrain", "My Valley.TIF")
    assert asset.expires == pytest.approx(time.time() + 100, abs=5)
    (entry,) = store.list()
    assert entry == {"hash": digest, "kind": "terrain", "name": "My Valley.TIF", "bytes": 7, "expires": asset.expires}


def test_the_hash_covers_all_that_a_loader_sees(store: AssetStore) -> None:
    first = store.put(b"data", "mesh", "a.ply")
    assert store.put(b"data", "mesh", "other name.PLY") == first
    others = {store.put(*other) for other in (
        (b"data", "mesh", "a.obj"), (b"data", "volume", "a.ply"), (b"d", "mesh", "a.ply"))}
    assert first not in others
    assert len(others) == 3


@pytest.mark.parametrize("name", ["tree", "tree.exe", "tree.ply/../../x.sh", ".npz", "a.np\0z"])
def test_an_ending_that_nothing_reads_is_refused(store: AssetStore, name: str) -> None:
    with pytest.raises(AssetError) as refused:
        store.put(b"data", "mesh", name)
    assert refused.value.field == "file"
    assert ".ply" in refused.value.allowed
    assert store.list() == []


def test_a_name_never_becomes_a_path(store: AssetStore) -> None:
    digest = store.put(b"data", "mesh", "../../../escape.ply")
    assert store.get(digest).path == store.folder / f"{digest}.ply"


def test_the_quota_refuses_in_words_and_repeats_are_free(store: AssetStore) -> None:
    digest = store.put(b"x" * 900, "mesh", "a.ply")
    assert store.put(b"x" * 900, "mesh", "a.ply") == digest
    with pytest.raises(LimitError) as refused:
        store.put(b"y" * 101, "mesh", "b.ply")
    assert "100 bytes" in refused.value.allowed
    store.put(b"y" * 100, "mesh", "b.ply")


def test_an_expired_asset_is_gone_and_frees_its_place(store: AssetStore) -> None:
    old = store.put(b"x" * 900, "mesh", "a.ply")
    note = store.folder / f"{old}.note"
    os.utime(note, (time.time() - 101,) * 2)
    with pytest.raises(AssetError, match="expired"):
        store.get(old)
    store.put(b"y" * 900, "mesh", "b.ply")
    assert not note.exists()
    assert not (store.folder / f"{old}.ply").exists()


def test_use_puts_off_the_end(store: AssetStore) -> None:
    digest = store.put(b"data", "mesh", "a.ply")
    os.utime(store.folder / f"{digest}.note", (time.time() - 90,) * 2)
    assert store.get(digest).expires > time.time() + 90


@pytest.mark.parametrize("digest", ["", "0" * 64, "../secret", "Z" * 64])
def test_an_unknown_hash_is_refused(store: AssetStore, digest: str) -> None:
    with pytest.raises(AssetError) as refused:
        store.get(digest)
    assert refused.value.field == "asset"


def test_a_truncated_file_is_refused(store: AssetStore) -> None:
    digest = store.put(b"data", "mesh", "a.ply")
    store.get(digest).path.write_bytes(b"da")
    with pytest.raises(AssetError):
        store.get(digest)
