"""Long work: precomputation, and comparison with the reference."""

from __future__ import annotations

from typing import Any, Literal

from fastapi import APIRouter, Path
from pydantic import Field
from starlette.responses import Response

from server.hub import Hub, TheHub
from server.jobs import Job, Result
from server.problems import Json, Missing
from server.routes.render import StateRequest, state_of

router = APIRouter(prefix="/api/jobs", tags=["jobs"])
REFERENCE_PIXELS = 256 * 256
"""A reference is computed on the CPU: up to 256 pixels wide it is affordable (study.md)."""
Identity = Path(max_length=64)


class JobRequest(StateRequest):
    """Long work on a state."""

    kind: Literal["bake", "reference"] = Field(description="What to do.")
    width: int = Field(128, ge=1, description="Of a reference, in pixels.")
    height: int = Field(128, ge=1, description="Of a reference, in pixels.")


@router.post(
    "",
    summary="Start long work",
    status_code=202,
    responses={422: {"description": "A field was refused"}, 503: {"description": "The queue is full"}},
)
async def start(hub: TheHub, asked: JobRequest) -> Response:
    """Queue a precomputation (`bake`) or a comparison with the reference (`reference`); answers its id."""
    state = await state_of(hub, asked)
    if asked.kind == "reference":
        hub.check_size(asked.width, asked.height, REFERENCE_PIXELS)
    work = _bake if asked.kind == "bake" else _reference
    job = hub.jobs.start(asked.kind, lambda job: work(hub, job, state, asked))
    return Json(job.document(), 202, {"Location": f"/api/jobs/{job.id}"})


def _bake(hub: Hub, job: Job, state: Any, asked: JobRequest) -> Result:
    preparation = hub.session.prepare(state, job.advance)
    job.on_stop(preparation.cancel)
    preparation.future.result()
    return Result()


def _reference(hub: Hub, job: Job, state: Any, asked: JobRequest) -> Result:
    found = hub.session.compare(state, asked.width, asked.height, job.advance)
    return Result(dict(found.files), dict(found.numbers))


@router.get("", summary="Known jobs")
async def listing(hub: TheHub) -> Response:
    """Jobs that wait, run or are over, the newest last."""
    return Json([job.document() for job in hub.jobs.list()])


@router.get("/{number}", summary="One job", responses={404: {"description": "There is no such job"}})
async def job(hub: TheHub, number: str = Identity) -> Response:
    """Status, progress, and the result once there is one."""
    return Json(hub.jobs.get(number).document())


@router.delete("/{number}", summary="Cancel a job", responses={404: {"description": "There is no such job"}})
async def cancel(hub: TheHub, number: str = Identity) -> Response:
    """Cancel a job, or forget one that is over."""
    found = hub.jobs.get(number)
    hub.jobs.cancel(found)
    return Json(found.document())


@router.get(
    "/{number}/files/{name}",
    summary="A file of a job's result",
    response_class=Response,
    responses={200: {"content": {"image/png": {}}}, 404: {"description": "There is no such file"}},
)
async def file(hub: TheHub, number: str = Identity, name: str = Path(max_length=100)) -> Response:
    """A picture that a job left."""
    result = hub.jobs.get(number).result
    if result is None or name not in result.files:
        raise Missing("name", "the job left no such file", ", ".join(result.files) if result else "")
    return Response(result.files[name], media_type="image/png", headers={"Cache-Control": "private, max-age=3600"})
