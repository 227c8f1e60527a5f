"""Physical quantities instead of pictures."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from pathlib import Path as FilePath
from typing import Annotated, Any

import numpy as np
from fastapi import APIRouter, Body, Path, Request
from starlette.responses import Response

from renderer.core.errors import InputError
from server import facade
from server.hub import Hub, TheHub
from server.problems import Json, Missing

router = APIRouter(prefix="/api/measure", tags=["measure"])
ASSET = "asset:"
NPZ = "application/x-npz"
ANSWERS: dict[int | str, dict[str, Any]] = {
    200: {
        "content": {"application/json": {}, NPZ: {}},
        "description": "Arrays by name, and `meta`: units, technique, error",
    },
    422: {"description": "An argument was refused"},
}


@router.get("", summary="Quantities")
async def quantities(hub: TheHub) -> Response:
    """What can be measured: the arguments' schema, the files it reads, the units of its results."""
    return Json(await hub.call(hub.session.quantities))


@router.get("/{quantity}", summary="Measure, with the arguments in the address", responses=ANSWERS)
async def get(request: Request, hub: TheHub, quantity: str = Path(max_length=100)) -> Response:
    """Measure a quantity; each argument is a query parameter, numbers and lists as JSON."""
    arguments = {name: _value(text) for name, text in request.query_params.items() if name != "token"}
    return await _measure(request, hub, quantity, arguments)


@router.post("/{quantity}", summary="Measure", responses=ANSWERS)
async def post(
    request: Request,
    hub: TheHub,
    arguments: Annotated[dict[str, Any], Body(max_length=1000)],
    quantity: str = Path(max_length=100),
) -> Response:
    """Measure a quantity. A file argument is `asset:HASH`. Answers JSON, or `.npz` by Accept."""
    return await _measure(request, hub, quantity, arguments)


def _value(text: str) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return text


async def _measure(request: Request, hub: Hub, quantity: str, arguments: dict[str, Any]) -> Response:
    found = await hub.work(_run, hub, quantity, arguments)
    if NPZ in request.headers.get("accept", ""):
        return Response(await hub.call(_npz, found), media_type=NPZ)
    return Json(
        {
            "quantity": quantity,
            **{name: np.asarray(values) for name, values in found.arrays.items()},
            "meta": dict(found.meta),
        }
    )


def _run(hub: Hub, quantity: str, arguments: dict[str, Any]) -> facade.Measurement:
    known = {entry["name"]: entry for entry in hub.session.quantities()}
    if quantity not in known:
        raise Missing("quantity", "there is no such quantity", ", ".join(known))
    names = {entry["name"] for entry in known[quantity]["files"]}
    given = {name: value for name, value in arguments.items() if name in names and isinstance(value, str)}
    files = asset_files(hub, given)
    plain = {name: value for name, value in arguments.items() if name not in given}
    return hub.session.measure(quantity, plain, files)


def asset_files(hub: Hub, given: Mapping[str, str]) -> dict[str, FilePath]:
    """Paths of uploaded files, by the names under which they are used.

    Raises:
        InputError: what is given is no upload, or it has expired.
    """
    files: dict[str, FilePath] = {}
    for name, value in given.items():
        if not value.startswith(ASSET):
            raise InputError(name, "is a file: upload it first", "asset:HASH, from POST /api/assets")
        files[name] = hub.session.assets.get(value.removeprefix(ASSET)).path
    return files


def _npz(found: facade.Measurement) -> bytes:
    buffer = io.BytesIO()
    arrays: dict[str, Any] = {name: np.asarray(values) for name, values in found.arrays.items()}
    np.savez(buffer, meta=np.array(json.dumps(dict(found.meta))), **arrays)
    return buffer.getvalue()
