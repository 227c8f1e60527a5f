"""Files that users bring: checked, stored by content, used in any state as `asset:HASH`."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

from fastapi import APIRouter, Request
from fastapi import Path as PathField
from starlette.responses import Response

from renderer.core.errors import InputError
from server.hub import TheHub
from server.problems import Json, missing
from server.uploads import receive

router = APIRouter(tags=["assets"])
FORM: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "multipart/form-data": {
                "schema": {
                    "type": "object",
                    "required": ["file"],
                    "properties": {"file": {"type": "string", "format": "binary", "description": "The file."}},
                    "additionalProperties": {
                        "type": "string",
                        "description": "What the file leaves unsaid, as `holes`, `cell_size` or `up`; lists are JSON.",
                    },
                }
            }
        },
    }
}


@router.post(
    "/api/assets",
    summary="Upload a file",
    status_code=201,
    openapi_extra=FORM,
    responses={413: {"description": "The file is too large"}, 422: {"description": "The file was refused"}},
)
async def upload(request: Request, hub: TheHub) -> Response:
    """Check and store a terrain, mesh, volume or other file; answers its name in documents, its kind and a preview.

    Fields beside `file` say what the file leaves unsaid, as a document's `reading` does: `holes=fill`,
    `cell_size=[12, 12]`. The file is checked as read so; the answer repeats them, for the document to say them too.
    """
    with hub.admitted(), tempfile.TemporaryDirectory(prefix="umbrage-upload-") as folder:
        path = Path(folder) / "upload"  # the client's name is no path
        try:
            came = await receive(request, path, hub.settings.upload_bytes, hub.call)
            answer = await hub.busy(hub.session.add_asset, path, came.name, came.fields)
        except InputError:
            hub.metrics.uploads.labels("refused").inc()
            raise
    hub.metrics.uploads.labels("stored").inc()
    return Json(answer, 201)


@router.get("/api/assets", summary="Stored files")
async def listing(hub: TheHub) -> Response:
    """Every stored file with its kind, size and expiry."""
    return Json(await hub.call(hub.session.assets.list))


@router.get(
    "/api/assets/{digest}", summary="One stored file", responses={404: {"description": "There is no such file"}}
)
async def asset(hub: TheHub, digest: str = PathField(max_length=100)) -> Response:
    """Kind, name and expiry of a stored file; asking puts its expiry off."""
    with missing():
        found = await hub.call(hub.session.assets.get, digest.removeprefix("asset:"))
    return Json({"hash": digest, "kind": found.kind, "name": found.name, "expires": found.expires})
