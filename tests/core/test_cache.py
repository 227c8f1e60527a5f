"""The cache gives back what was put in, or nothing: whatever happened to the file or to its writer."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from renderer.core.cache import Cache, key_of
from renderer.core.files import GRACE_S, TEMPORARY, locked, sweep, write_atomically

ARRAYS = {"elevation": np.arange(12, dtype=np.float32).reshape(3, 4), "base": np.asarray(7.5)}
KEY = key_of("terrain", {"side": 4})


@pytest.fixture
def cache(tmp_path: Path) -> Cache:
    return Cache(tmp_path)


def same(found: dict[str, np.ndarray] | None) -> bool:
    return found is not None and found.keys() == ARRAYS.keys() and all(
        found[name].dtype == ARRAYS[name].dtype and np.array_equal(found[name], ARRAYS[name]) for name in ARRAYS)


def test_returns_what_was_put(cache: Cache) -> None:
    assert cache.get(KEY) is None
    assert KEY not in cache
    cache.put(KEY, ARRAYS)
    assert KEY in cache
    assert same(cache.get(KEY))


def test_an_entry_is_a_plain_npz(cache: Cache) -> None:
    cache.put(KEY, ARRAYS)
    with np.load(cache.path(KEY), allow_pickle=False) as archive:
        assert np.array_equal(archive["elevation"], ARRAYS["elevation"])


def test_refuses_objects_and_leaves_nothing(cache: Cache) -> None:
    with pytest.raises(ValueError, match="Object arrays"):
        cache.put(KEY, {"trees": np.asarray([{}], dtype=object)})
    assert [path for path in cache.folder.rglob("*") if path.is_file()] == []


@pytest.mark.parametrize("key", ["", "../../etc/passwd", "A" * 64, KEY + "0", KEY.upper()])
def test_refuses_what_is_no_key(cache: Cache, key: str) -> None:
    with pytest.raises(ValueError, match="not a cache key"):
        cache.get(key)


def test_key_follows_the_value_not_the_spelling() -> None:
    assert key_of({"a": 1, "b": [1.5, None]}) == key_of({"b": (1.5, None), "a": 1})
    assert len({key_of(1), key_of("1"), key_of([1]), key_of(1, 1), key_of({"1": 1})}) == 5
    with pytest.raises(ValueError, match="not JSON compliant"):
        key_of(float("nan"))


def truncate(data: bytearray) -> None:
    del data[len(data) // 2:]


def empty(data: bytearray) -> None:
    data.clear()


def garbage(data: bytearray) -> None:
    data[:] = b"\x80\x04" * 500


@pytest.mark.parametrize("damage", [truncate, empty, garbage])
def test_a_damaged_file_is_a_miss_and_is_deleted(cache: Cache, damage: Callable[[bytearray], None]) -> None:
    cache.put(KEY, ARRAYS)
    data = bytearray(cache.path(KEY).read_bytes())
    damage(data)
    cache.path(KEY).write_bytes(data)
    assert cache.get(KEY) is None
    assert not cache.path(KEY).exists()
    cache.put(KEY, ARRAYS)
    assert same(cache.get(KEY))


def test_no_flipped_bit_changes_a_value(cache: Cache) -> None:
    """Each byte of the file in turn: the entry is a miss, or (in a time stamp, say) still right."""
    cache.put(KEY, ARRAYS)
    whole = cache.path(KEY).read_bytes()
    misses = 0
    for place in range(len(whole)):
        data = bytearray(whole)
        data[place] ^= 0x10
        cache.path(KEY).write_bytes(data)
        found = cache.get(KEY)
        misses += found is None
        assert found is None or same(found), place
    assert misses > 200


def test_a_killed_writer_leaves_no_entry_and_is_cleaned_up(cache: Cache) -> None:
    script = ("import sys, time; from pathlib import Path; from renderer.core.files import write_atomically\n"
              "def write(file):\n"
              "    file.write(b'half'); file.flush(); print('writing', flush=True); time.sleep(60)\n"
              "write_atomically(Path(sys.argv[1]), write)\n")
    with subprocess.Popen([sys.executable, "-c", script, str(cache.path(KEY))], stdout=subprocess.PIPE) as writer:
        assert writer.stdout is not None
        assert writer.stdout.readline() == b"writing\n"
        (half,) = cache.folder.rglob(f"{TEMPORARY}*")
        os.utime(half, (time.time() - 2 * GRACE_S,) * 2)
        sweep(cache.folder)
        assert half.exists(), "a living writer's file was taken away"
        writer.send_signal(signal.SIGKILL)
        writer.wait()
    assert cache.get(KEY) is None
    cache.put(key_of("another"), ARRAYS)
    assert not half.exists()


def test_a_writer_that_has_not_locked_its_file_yet_is_left_alone(tmp_path: Path) -> None:
    fresh = tmp_path / f"{TEMPORARY}fresh"
    fresh.touch()
    sweep(tmp_path)
    assert fresh.exists()


def test_a_failing_writer_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_bytes(b"old")
    with pytest.raises(ZeroDivisionError):
        write_atomically(path, lambda file: file.write(b"new" * (1 // 0)))
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_two_processes_write_the_same_key(cache: Cache) -> None:
    script = ("import sys; import numpy as np; from pathlib import Path; from renderer.core.cache import Cache\n"
              "cache = Cache(Path(sys.argv[1]))\n"
              "for _ in range(40):\n"
              "    cache.put(sys.argv[2], {'a': np.full(5000, 3)})\n"
              "    found = cache.get(sys.argv[2])\n"
              "    assert found is not None and (found['a'] == 3).all()\n")
    both = [subprocess.Popen([sys.executable, "-c", script, str(cache.folder), KEY]) for _ in range(2)]
    assert [process.wait(60) for process in both] == [0, 0]
    assert [path.name for path in (cache.folder / "arrays").rglob("*.npz")] == [f"{KEY}.npz"]


def test_the_longest_unused_goes_first(tmp_path: Path) -> None:
    cache = Cache(tmp_path, limit_bytes=3 * 9000)
    keys = [key_of(index) for index in range(4)]
    for index, key in enumerate(keys[:3]):
        cache.put(key, {"a": np.zeros(1000)})
        os.utime(cache.path(key), (1000 + index,) * 2)
    assert cache.get(keys[0]) is not None  # the oldest, but used just now
    cache.put(keys[3], {"a": np.zeros(1000)})
    assert [key in cache for key in keys] == [True, False, True, True]


def test_the_newest_stays_even_when_it_alone_is_too_large(tmp_path: Path) -> None:
    cache = Cache(tmp_path, limit_bytes=100)
    cache.put(KEY, ARRAYS)
    other = key_of("other")
    cache.put(other, ARRAYS)
    assert (KEY in cache, other in cache) == (False, True)


def test_a_lock_that_somebody_holds_can_be_given_up(tmp_path: Path) -> None:
    def give_up() -> None:
        raise TimeoutError

    with locked(tmp_path / "lock"), pytest.raises(TimeoutError), locked(tmp_path / "lock", give_up):
        pass
    with locked(tmp_path / "lock", give_up):
        pass


def test_the_folder_is_named_by_the_environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("UMBRAGE_CACHE", str(tmp_path / "named"))
    assert Cache().folder == tmp_path / "named"
    monkeypatch.delenv("UMBRAGE_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert Cache().folder == tmp_path / "umbrage"
