"""What a scene is built of, as lines to lay over its picture."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
from fastapi import APIRouter
from starlette.responses import Response

from server.hub import TheHub
from server.problems import Json
from server.routes.render import StateRequest, state_of

router = APIRouter(tags=["render"])


@router.post(
    "/api/outline",
    summary="Lines of what a scene is built of",
    responses={
        200: {"description": "`arrays` by name, each `dtype`, `shape` and `base64`; `facts`; `words`"},
        422: {"description": "A field was refused, or the scene has no lines"},
        503: {"description": "Too busy"},
    },
)
async def outline(hub: TheHub, asked: StateRequest) -> Response:
    """Vertices, edges with their marks and triangles of a shell, as it stands at the state's time.

    Bytes are in little-endian order, rows first: `positions` [2V, 3] m, of the surface, then of the shell's top; `rest`
    [V, 3], where paint has its places; `faces` [F, 3]; `ends` [E, 2]; `marks` [E]: 0 an edge of the surface, 1 of the
    top, 2 along an offset, 3 across a side, plus 4 in conflict, 8 shorter than wanted, 16 in conflict before.
    """
    state = await state_of(hub, asked)
    found = await hub.work(hub.session.outline, state)
    arrays = await hub.call(lambda: {name: _coded(array) for name, array in found.arrays.items()})
    return Json({"arrays": arrays, "facts": dict(found.facts), "words": list(found.words)})


def _coded(array: np.ndarray) -> dict[str, Any]:
    plain = np.ascontiguousarray(array, array.dtype.newbyteorder("<"))
    return {
        "dtype": plain.dtype.name,
        "shape": list(plain.shape),
        "base64": base64.b64encode(plain.tobytes()).decode("ascii"),
    }
