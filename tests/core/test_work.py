"""Bakes run once, elsewhere, with progress; they can be cancelled, and their failures reach the caller in words."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from renderer.core.cache import Cache
from renderer.core.channel import Progress
from renderer.core.errors import AssetError, Cancelled, UmbrageError
from renderer.core.technique import Bake
from renderer.core.work import Workers, bake_key, bake_now, expected_seconds, missing
from tests.core.bakes import bake, die, endless, fail, refuse, square, total

WAIT_S = 30.0


@pytest.fixture
def cache(tmp_path: Path) -> Cache:
    return Cache(tmp_path / "cache")


@pytest.fixture(scope="module")
def workers() -> Iterator[Workers]:
    """One pool for the file: starting a process is the slow part."""
    pool = Workers(processes=1)
    yield pool
    pool.close()


def until(condition: Callable[[], bool]) -> None:
    end = time.monotonic() + WAIT_S
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)


def sums(count: int = 4) -> Bake:
    return bake(total, (bake(square, count=count),))


def test_bakes_inputs_first_and_keeps_both(cache: Cache) -> None:
    task = sums()
    assert [step.name for step in missing([task], cache)] == ["square", "total"]
    assert bake_now(task, cache)["total"] == 0 + 1 + 4 + 9
    assert missing([task], cache) == []
    assert all(bake_key(step) in cache for step in (task, *task.inputs))


def test_an_input_is_not_needed_where_the_result_is_known(cache: Cache) -> None:
    task = sums()
    bake_now(task, cache)
    cache.path(bake_key(task.inputs[0])).unlink()
    assert expected_seconds([task], cache) == 0
    assert bake_now(task, cache)["total"] == 14
    assert bake_key(task.inputs[0]) not in cache


def test_the_key_covers_all_that_decides_the_result() -> None:
    base = sums()
    renamed = Bake("other", total, {}, base.inputs)
    changed = [sums(5), Bake("total", total, {}, base.inputs, version=2), Bake("total", square, {}, base.inputs),
               Bake("total", total, {"a": 1}, base.inputs), Bake("total", total, {})]
    assert bake_key(renamed) == bake_key(base)
    assert len({bake_key(step) for step in [base, *changed]}) == 6


def test_progress_covers_the_whole_and_never_falls(cache: Cache) -> None:
    told: list[Progress] = []
    long = Bake("square", square, {"count": 3}, seconds=3.0)
    bake_now(Bake("total", total, {}, (long,), seconds=1.0), cache, told.append)
    assert [(step.name, step.words) for step in told] == [
        ("square", "starting"), ("square", "squaring"), ("total", "starting")]
    assert [step.fraction for step in told] == [0.0, 0.375, 0.75]
    assert told[0].seconds_left == pytest.approx(4.0)


def test_progress_that_raises_ends_the_work(cache: Cache) -> None:
    def stop(progress: Progress) -> None:
        raise Cancelled("enough")

    with pytest.raises(Cancelled):
        bake_now(sums(), cache, stop)
    assert len(missing([sums()], cache)) == 2


def test_a_worker_process_does_the_work(workers: Workers, cache: Cache, tmp_path: Path) -> None:
    marks = tmp_path / "marks"
    marks.mkdir()
    source = bake(square, count=4, marks=str(marks), pause_s=0.3)
    told: list[Progress] = []
    result = workers.run(bake(total, (source,)), cache, told.append).future.result(WAIT_S)
    assert result["total"] == 14
    (mark,) = marks.iterdir()
    assert int(mark.name.split("-")[0]) != os.getpid()
    assert told[0].name == "square"


def test_several_bakes_are_one_task(workers: Workers, cache: Cache) -> None:
    found = workers.run_all([bake(square, count=4), sums()], cache).future.result(WAIT_S)
    assert found["square"]["values"].tolist() == [0, 1, 4, 9]
    assert found["total"]["total"] == 14


def test_what_is_cached_needs_no_worker(cache: Cache) -> None:
    bake_now(sums(), cache)
    pool = Workers(executor=ThreadPoolExecutor())
    pool._given.shutdown()  # type: ignore[union-attr]
    assert pool.run(sums(), cache).future.result(WAIT_S)["total"] == 14
    pool.close()


def test_identical_bakes_asked_at_once_run_once(workers: Workers, cache: Cache, tmp_path: Path) -> None:
    step = bake(square, count=3, marks=str(tmp_path), pause_s=0.2)
    before = set(tmp_path.iterdir())
    tasks = [workers.run(step, cache) for _ in range(5)]
    assert all(task.future.result(WAIT_S)["values"].tolist() == [0, 1, 4] for task in tasks)
    assert len({path.name for path in set(tmp_path.iterdir()) - before} - {"cache"}) == 1


def test_the_same_bake_in_two_processes_runs_once(cache: Cache, tmp_path: Path) -> None:
    """As two servers that share a cache do: the second waits for the first's result."""
    step = bake(square, count=3, marks=str(tmp_path), pause_s=0.5)
    pools = [Workers(), Workers()]
    tasks = [pool.run(step, cache) for pool in pools]
    assert all(task.future.result(WAIT_S)["values"].tolist() == [0, 1, 4] for task in tasks)
    assert len([path for path in tmp_path.iterdir() if path.is_file()]) == 1
    for pool in pools:
        pool.close()


def test_cancelling_stops_the_work(workers: Workers, cache: Cache, tmp_path: Path) -> None:
    started = threading.Event()
    task = workers.run(bake(endless, ended=str(tmp_path / "ended")), cache, lambda progress: started.set())
    assert started.wait(WAIT_S)
    task.cancel()
    with pytest.raises(Cancelled):
        task.future.result(0)
    until((tmp_path / "ended").exists)
    until(lambda: not any((cache.folder / "work").iterdir()))
    assert workers.run(sums(), cache).future.result(WAIT_S)["total"] == 14


def test_a_second_owner_keeps_the_work_going(workers: Workers, cache: Cache, tmp_path: Path) -> None:
    step = bake(square, count=3, marks=str(tmp_path), pause_s=0.5)
    first, second = workers.run(step, cache), workers.run(step, cache)
    first.cancel()
    first.cancel()
    assert isinstance(first.future.exception(0), Cancelled)
    assert second.future.result(WAIT_S)["values"].tolist() == [0, 1, 4]
    second.cancel()
    assert second.future.exception(0) is None


def test_awaiting_and_giving_up_leaves_the_task_whole(workers: Workers, cache: Cache) -> None:
    task = workers.run(sums(), cache)
    assert not task.future.cancel()
    assert task.future.result(WAIT_S)["total"] == 14


def test_a_listener_that_fails_disturbs_nobody(workers: Workers, cache: Cache, tmp_path: Path,
                                                caplog: pytest.LogCaptureFixture) -> None:
    step = bake(square, count=3, marks=str(tmp_path), pause_s=0.5)

    def broken(progress: Progress) -> None:
        raise ZeroDivisionError

    assert workers.run(step, cache, broken).future.result(WAIT_S)["values"].tolist() == [0, 1, 4]
    assert "a listener to progress failed" in caplog.text


def test_a_refused_file_is_refused_to_the_caller(workers: Workers, cache: Cache) -> None:
    with pytest.raises(AssetError) as refused:
        workers.run(bake(refuse), cache).future.result(WAIT_S)
    assert refused.value.as_dict() == {
        "field": "terrain", "message": "has a hole", "allowed": "a height in every cell"}


def test_a_failing_bake_raises_in_the_caller_and_is_not_cached(workers: Workers, cache: Cache) -> None:
    for _ in range(2):
        with pytest.raises(UmbrageError, match="fail could not be computed: KeyError: 'nonsense'"):
            workers.run(bake(fail), cache).future.result(WAIT_S)
    assert bake_key(bake(fail)) not in cache


def test_a_dying_process_is_reported_and_replaced(cache: Cache) -> None:
    pool = Workers()
    doomed = pool.run(bake(die), cache)
    with pytest.raises(UmbrageError, match="die ended unexpectedly"):
        doomed.future.result(WAIT_S)
    assert pool.run(sums(), cache).future.result(WAIT_S)["total"] == 14
    pool.close()


def test_any_executor_fits(cache: Cache) -> None:
    with ThreadPoolExecutor(1) as executor:
        pool = Workers(executor=executor)
        assert pool.run(sums(), cache).future.result(WAIT_S)["total"] == 14
        pool.close()


def test_closing_ends_work_processes_and_threads(cache: Cache, tmp_path: Path) -> None:
    pool = Workers()
    started = threading.Event()
    task = pool.run(bake(endless, ended=str(tmp_path / "ended")), cache, lambda progress: started.set())
    assert started.wait(WAIT_S)
    processes = list(pool._own._processes.values())  # type: ignore[union-attr]
    pool.close()
    assert isinstance(task.future.exception(0), Cancelled)
    assert not any(process.is_alive() for process in processes)
    assert not any(thread.name == "bake" and thread in pool._threads and thread.is_alive()
                   for thread in threading.enumerate())
    with pytest.raises(UmbrageError, match="closed"):
        pool.run(sums(), cache)
