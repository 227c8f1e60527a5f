from __future__ import annotations

import asyncio
import io
import threading
import time
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from starlette.testclient import TestClient

from server.jobs import Job, Jobs, Result
from server.metrics import Metrics
from server.problems import Busy, Missing
from server.settings import Settings
from tests.server.fake_session import FakeSession


def followed(client: TestClient, number: str) -> dict[str, Any]:
    """The job once it is over."""
    for _ in range(500):
        job: dict[str, Any] = client.get(f"/api/jobs/{number}").json()
        if job["status"] in ("done", "failed", "cancelled"):
            return job
        time.sleep(0.01)
    raise AssertionError("the job never ended")


def test_a_reference_leaves_pictures_and_numbers(client: TestClient) -> None:
    body = {"kind": "reference", "scene": "fake", "width": 32, "height": 32, "quality": {"kind": "draft"}}
    started = client.post("/api/jobs", json=body)
    assert started.status_code == 202
    job = followed(client, started.json()["id"])
    assert job["status"] == "done"
    assert job["result"]["relative_rmse"] == 0.1
    picture = client.get(job["result"]["files"]["reference.png"])
    assert picture.content.startswith(b"\x89PNG")
    assert client.get(f"/api/jobs/{job['id']}/files/other.png").status_code == 404
    client.delete(f"/api/jobs/{job['id']}")
    assert client.get(f"/api/jobs/{job['id']}").status_code == 404


def test_a_bake_is_followed_and_cancelled(client: TestClient, session: FakeSession) -> None:
    session.bake_gate.clear()
    number = client.post("/api/jobs", json={"kind": "bake", "scene": "fake", "sets": {"density": 7}}).json()["id"]
    while client.get(f"/api/jobs/{number}").json()["words"] != "baking":
        time.sleep(0.01)
    client.delete(f"/api/jobs/{number}")
    assert followed(client, number)["status"] == "cancelled"
    assert session.preparations[-1].cancelled


def test_a_failed_job_names_the_field(client: TestClient) -> None:
    number = client.post("/api/jobs", json={"kind": "bake", "scene": "fake", "sets": {"density": 999}}).json()["id"]
    job = followed(client, number)
    assert (job["status"], job["errors"][0]["field"]) == ("failed", "density")


@pytest.mark.parametrize(
    ("change", "field"),
    [({"kind": "walrus"}, "kind"), ({"width": 2000, "height": 2000}, "width"), ({"scene": "atlantis"}, "scene")],
)
def test_a_wrong_job_names_its_field(client: TestClient, change: dict[str, Any], field: str) -> None:
    answer = client.post("/api/jobs", json={"kind": "reference", "scene": "fake", **change})
    assert (answer.status_code, answer.json()["errors"][0]["field"]) == (422, field)


def test_a_sun_study_leaves_maps(client: TestClient) -> None:
    asset = client.post("/api/assets", files={"file": ("a.npz", b"good land")}).json()["asset"]
    for body, hours in (({"scene": "fake"}, 12.0), ({"files": {"terrain": asset}}, 9.0)):
        number = client.post("/api/jobs", json={"kind": "sunlight", "period": {"start": "2024-01-01"}, **body}).json()
        result = followed(client, number["id"])["result"]
        assert result["hours"]["mean"] == hours
        kinds = {name: client.get(url).headers["content-type"] for name, url in result["files"].items()}
        assert kinds == {
            f"{name}.{ending}": media
            for name in ("hours", "insolation")
            for ending, media in (("tif", "image/tiff"), ("png", "image/png"), ("npy", "application/x-npy"))
        }
        array = np.load(io.BytesIO(client.get(result["files"]["insolation.npy"]).content))
        assert np.all(array == hours / 2)
    wrong = client.post("/api/jobs", json={"kind": "sunlight", "scene": "fake", "period": {"begin": 1}}).json()["id"]
    assert followed(client, wrong)["errors"][0]["field"] == "begin"
    both = client.post("/api/jobs", json={"kind": "sunlight", "scene": "fake", "files": {"terrain": asset}})
    assert (both.status_code, both.json()["errors"][0]["field"]) == (422, "files")
    absent = client.post("/api/jobs", json={"kind": "sunlight", "files": {"terrain": "hill.tif"}}).json()["id"]
    assert followed(client, absent)["errors"][0]["field"] == "terrain"


def test_a_sun_study_is_followed_and_cancelled(client: TestClient, session: FakeSession) -> None:
    session.bake_gate.clear()
    number = client.post("/api/jobs", json={"kind": "sunlight", "scene": "fake"}).json()["id"]
    while client.get(f"/api/jobs/{number}").json()["fraction"] != 0.5:
        time.sleep(0.01)
    client.delete(f"/api/jobs/{number}")
    assert followed(client, number)["status"] == "cancelled"


def slow(job: Job) -> Result:
    while True:
        job.advance(SimpleNamespace(fraction=0.5, words="working", seconds_left=None))
        time.sleep(0.005)


async def until(job: Job, status: str) -> None:
    for _ in range(1000):
        if job.status == status:
            return
        await asyncio.sleep(0.005)
    raise AssertionError(f"the job is {job.status}, not {status}")


async def test_the_queue_is_bounded_and_a_waiting_job_can_be_cancelled() -> None:
    jobs = Jobs(Settings(jobs=2, jobs_running=1), Metrics())
    first, second = jobs.start("bake", slow), jobs.start("bake", slow)
    await until(first, "running")
    assert second.status == "queued"
    with pytest.raises(Busy, match="2 at once"):
        jobs.start("bake", slow)
    jobs.cancel(second)
    await until(second, "cancelled")
    jobs.cancel(first)
    await until(first, "cancelled")
    third = jobs.start("bake", lambda job: Result())
    await until(third, "done")
    await jobs.close()


async def test_results_are_forgotten_in_time() -> None:
    jobs = Jobs(Settings(jobs=2, jobs_kept=1), Metrics())
    kept = [jobs.start("bake", lambda job: Result()) for _ in range(2)]
    for job in kept:
        await until(job, "done")
    third = jobs.start("bake", lambda job: Result())
    await until(third, "done")
    assert kept[0] not in jobs.list()
    assert kept[1] in jobs.list()
    third.ended = time.monotonic() - 2
    with pytest.raises(Missing):
        jobs.get(third.id)
    await jobs.close()


async def test_results_are_forgotten_for_their_mass(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two maps do not fit: the older goes; one that fits in no way is kept until the next."""
    monkeypatch.setattr("server.jobs.KEPT_BYTES", 150)
    jobs = Jobs(Settings(), Metrics())
    for size, known in ((100, [100]), (100, [100]), (20, [100, 20]), (999, [999])):
        await until(jobs.start("sunlight", lambda job, size=size: Result({"map.tif": bytes(size)})), "done")  # type: ignore[misc]
        assert [job.result.size for job in jobs.list() if job.result is not None] == known
    await jobs.close()


async def test_closing_ends_what_runs() -> None:
    jobs = Jobs(Settings(), Metrics())
    job = jobs.start("bake", slow)
    await until(job, "running")
    await jobs.close()
    assert job.status == "cancelled"


async def test_closing_does_not_wait_for_work_that_listens_to_nothing() -> None:
    jobs = Jobs(Settings(), Metrics())
    let_go = threading.Event()

    def deaf(job: Job) -> Result:
        let_go.wait(30)
        return Result()

    job = jobs.start("bake", deaf)
    await until(job, "running")
    await jobs.close()
    assert not let_go.is_set()
    assert job.status == "running"
    let_go.set()
    await until(job, "done")
