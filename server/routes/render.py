"""Pictures over HTTP, in the format that the client accepts."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Request
from pydantic import Field
from starlette.responses import Response

from renderer.core.errors import InputError
from renderer.core.params import Model, merge
from server.hub import Hub, TheHub
from server.problems import Json, refuse
from server.rendering import draw

router = APIRouter(tags=["render"])
FORMATS = {"image/png": "png", "image/jpeg": "jpeg", "image/x-exr": "exr", "application/x-npy": "npy"}
"""Media types in the order of preference where a client accepts several alike."""
Name = Annotated[str, Field(max_length=100)]


class StateRequest(Model):
    """A state: a whole document, or a scene with a preset; then single parameters and the quality on top."""

    state: dict[str, Any] | None = Field(None, description="A whole state document, as the page shares it.")
    scene: Name | None = Field(None, description="A scene's name, where no state is given.")
    preset: Name | None = Field(None, description="One of the scene's presets.")
    combination: Name | None = Field(None, description="One of the scene's combinations of techniques.")
    sets: dict[str, Any] | None = Field(None, description="Values by dotted path, as `sun.elevation`.", max_length=1000)
    quality: dict[str, Any] | None = Field(None, description="Replaces the quality of the state.")


class RenderRequest(StateRequest):
    """A picture."""

    width: int = Field(512, ge=1, description="Pixels; the server's settings bound it.")
    height: int = Field(512, ge=1, description="Pixels; the server's settings bound it.")


async def state_of(hub: Hub, asked: StateRequest) -> Any:
    """The checked state that a request describes.

    Raises:
        InputError, InvalidDocument: naming the fields.
    """
    scene = asked.scene if asked.scene is not None else (asked.state or {}).get("scene")
    if not isinstance(scene, str):
        raise InputError("scene", "is missing", "a scene's name, here or in the state")
    state = await hub.call(hub.session.state, scene, asked.preset, asked.sets, asked.state, asked.combination)
    if asked.quality is None:
        return state
    return await hub.call(hub.session.validate, merge(state.model_dump(mode="json"), {"quality": asked.quality}))


def negotiate(accept: str) -> str | None:
    """The media type to answer with: the accepted one of highest quality value, the earlier in `FORMATS` where equal.

    Args:
        accept: the header (RFC 9110, 12.5.1); empty means anything.

    Returns:
        the media type, or None where none is acceptable.
    """
    wishes = []
    for entry in (accept or "*/*").split(","):
        media, *options = (part.strip() for part in entry.split(";"))
        weight = next((option[2:] for option in options if option.startswith("q=")), "1")
        try:
            wishes.append((media.lower(), float(weight)))
        except ValueError:
            wishes.append((media.lower(), 0.0))
    best, found = 0.0, None
    for media in FORMATS:
        ranges = {media: 3, media.split("/")[0] + "/*": 2, "*/*": 1}
        matching = max(((ranges[wish], weight) for wish, weight in wishes if wish in ranges), default=(0, 0.0))
        if matching[1] > best:
            best, found = matching[1], media
    return found


@router.post(
    "/api/cost", summary="What a state would cost", responses={422: {"description": "A field was refused"}}
)
async def cost(hub: TheHub, asked: StateRequest) -> Response:
    """`seconds` of precomputation on two cores before the state can be drawn; 0 where all of it is cached."""
    state = await state_of(hub, asked)
    return Json({"seconds": await hub.call(hub.session.expected_seconds, state)})


@router.post(
    "/api/render",
    summary="Draw a picture",
    response_class=Response,
    responses={
        200: {"content": {media: {} for media in FORMATS}, "description": "The picture"},
        406: {"description": "No format that the client accepts"},
        422: {"description": "A field was refused"},
        503: {"description": "Too busy"},
    },
)
async def render(request: Request, hub: TheHub, asked: RenderRequest) -> Response:
    """Draw a state; the format follows the Accept header: PNG, JPEG, EXR or .npy.

    EXR and `.npy` hold linear radiance, float32 RGBA, premultiplied, row 0 at the top.
    """
    media = negotiate(request.headers.get("accept", ""))
    if media is None:
        return refuse(406, "Accept", "no format that the client accepts", ", ".join(FORMATS))
    hub.check_size(asked.width, asked.height)
    state = await state_of(hub, asked)
    picture = await draw(hub, request, state, asked.width, asked.height)
    body = await hub.call(picture.encode, FORMATS[media])
    return Response(
        body,
        media_type=media,
        headers={
            "Vary": "Accept",
            "Cache-Control": "no-store",
            "X-Umbrage-Samples": str(picture.samples),
            "Server-Timing": f"render;dur={picture.render_ms:.1f}",
        },
    )
