"""Files that users bring: checked, stored by content, used in any state as `asset:HASH`."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path
from typing import Any, BinaryIO

from fastapi import APIRouter, UploadFile
from fastapi import Path as PathField
from starlette.responses import Response

from renderer.core.errors import InputError, LimitError
from server.hub import Hub, TheHub
from server.problems import Json, missing

router = APIRouter(tags=["assets"])
CHUNK = 1 << 20


@router.post(
    "/api/assets",
    summary="Upload a file",
    status_code=201,
    responses={413: {"description": "The file is too large"}, 422: {"description": "The file was refused"}},
)
async def upload(hub: TheHub, file: UploadFile) -> Response:
    """Check and store a terrain, mesh, volume or other file; answers its hash, kind, a preview and when it expires."""
    try:
        answer = await hub.call(_store, hub, file.file, file.filename or "")
    except InputError:
        hub.metrics.uploads.labels("refused").inc()
        raise
    hub.metrics.uploads.labels("stored").inc()
    return Json(answer, 201)


def _store(hub: Hub, source: BinaryIO, filename: str) -> dict[str, Any]:
    """Hand an upload to the session as a file of its own; the client's name is no path."""
    limit = hub.settings.upload_bytes
    with tempfile.TemporaryDirectory(prefix="umbrage-upload-") as folder:
        path = Path(folder) / "upload"
        with path.open("wb") as target:
            shutil.copyfileobj(source, target, CHUNK)
            if target.tell() > limit:
                raise LimitError("file", "the file is too large", f"at most {limit} bytes")
            if target.tell() == 0:
                raise InputError("file", "the file is empty")
        return hub.session.add_asset(path, Path(filename.replace("\\", "/")).name[:200])


@router.get("/api/assets", summary="Stored files")
async def listing(hub: TheHub) -> Response:
    """Every stored file with its kind, size and expiry."""
    return Json(await hub.call(hub.session.assets.list))


@router.get(
    "/api/assets/{digest}", summary="One stored file", responses={422: {"description": "There is no such file"}}
)
async def asset(hub: TheHub, digest: str = PathField(max_length=100)) -> Response:
    """Kind, name and expiry of a stored file; asking puts its expiry off."""
    with missing():
        found = await hub.call(hub.session.assets.get, digest.removeprefix("asset:"))
    return Json({"hash": digest, "kind": found.kind, "name": found.name, "expires": found.expires})
