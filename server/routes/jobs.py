"""Long work: precomputation, comparison with the reference, studies of the sun."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path as FilePath
from typing import Any, Literal

import numpy as np
from fastapi import APIRouter, Path
from pydantic import Field
from starlette.responses import Response

from renderer.core.errors import InputError
from server.hub import Hub, TheHub
from server.jobs import Job, Result
from server.problems import Json, Missing
from server.routes.measure import asset_files
from server.routes.render import Name, StateRequest, state_of
from server.sun_maps import MAPS, map_files

router = APIRouter(prefix="/api/jobs", tags=["jobs"])
REFERENCE_PIXELS = 256 * 256
"""A reference is computed on the CPU: up to 256 pixels wide it takes minutes."""
Identity = Path(max_length=64)
MEDIA = {".png": "image/png", ".tif": "image/tiff", ".npy": "application/x-npy"}
"""Media type of a job's files, by their ending."""


class JobRequest(StateRequest):
    """Long work on a state."""

    kind: Literal["bake", "reference", "sunlight"] = Field(description="What to do.")
    width: int = Field(128, ge=1, description="Of a reference, in pixels.")
    height: int = Field(128, ge=1, description="Of a reference, in pixels.")
    period: dict[str, Any] | None = Field(
        None, description="Of a study of the sun: the arguments of `/api/measure/sunlight` but for its points."
    )
    files: dict[Name, Name] | None = Field(
        None, description="Of a study without a state: `terrain` and `canopy`, as asset:HASH.", max_length=2
    )


@router.post(
    "",
    summary="Start long work",
    status_code=202,
    responses={422: {"description": "A field was refused"}, 503: {"description": "The queue is full"}},
)
async def start(hub: TheHub, asked: JobRequest) -> Response:
    """Queue a precomputation (`bake`), a comparison with the reference (`reference`), or maps of hours of sun and
    insolation (`sunlight`); answers its id."""
    landed = asked.kind == "sunlight" and asked.files is not None
    if landed and (asked.state is not None or asked.scene is not None):
        raise InputError("files", "are given beside a state, which has its own land", "one of the two")
    state = None if landed else await state_of(hub, asked)
    if asked.kind == "reference":
        hub.check_size(asked.width, asked.height, REFERENCE_PIXELS)
    work = WORK[asked.kind]
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


def _sunlight(hub: Hub, job: Job, state: Any, asked: JobRequest) -> Result:
    files = asset_files(hub, asked.files or {})
    found = hub.session.sunlight(asked.period or {}, state, files, job.advance)
    arrays = {f"{name}.npy": array_bytes(found.arrays[name]) for name in MAPS}
    return Result(map_files(found) | arrays, dict(found.numbers))


WORK: dict[str, Callable[[Hub, Job, Any, JobRequest], Result]] = {
    "bake": _bake,
    "reference": _reference,
    "sunlight": _sunlight,
}


def array_bytes(values: np.ndarray) -> bytes:
    """An array as `.npy`."""
    buffer = io.BytesIO()
    np.save(buffer, values, allow_pickle=False)
    return buffer.getvalue()


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
    responses={
        200: {"content": {media: {} for media in MEDIA.values()}},
        404: {"description": "There is no such file"},
    },
)
async def file(hub: TheHub, number: str = Identity, name: str = Path(max_length=100)) -> Response:
    """A picture or a map that a job left."""
    result = hub.jobs.get(number).result
    if result is None or name not in result.files:
        raise Missing("name", "the job left no such file", ", ".join(result.files) if result else "")
    media = MEDIA.get(FilePath(name).suffix, "application/octet-stream")
    return Response(result.files[name], media_type=media, headers={"Cache-Control": "private, max-age=3600"})
