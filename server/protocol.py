"""Messages of the WebSocket, protocol 1: JSON text both ways, and frames as binary.

A binary message is a little-endian uint32 (length of the header in bytes), the header as UTF-8 JSON, the image's bytes.
"""

from __future__ import annotations

import json
import math
import struct
from typing import Annotated, Any, Literal, Union

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from renderer.core.errors import InputError
from renderer.core.params import Model, validate

PROTOCOL = 1
Codec = Literal["jpeg", "png"]
CODECS: tuple[Codec, ...] = ("jpeg", "png")
Id = Annotated[int, Field(ge=0, le=2**53)]
Side = Annotated[int, Field(ge=1, le=65535)]
Fraction = Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]


class Hello(Model):
    """Opens the session; the first message of every client."""

    type: Literal["hello"]
    protocol: int
    width: Side
    height: Side
    state: dict[str, Any] | None = None
    scene: Annotated[str, Field(max_length=100)] | None = None
    preset: Annotated[str, Field(max_length=100)] | None = None
    codecs: Annotated[list[Annotated[str, Field(max_length=40)]], Field(max_length=16)] = ["jpeg", "png"]
    frame_ms: Annotated[float, Field(ge=5, le=1000, allow_inf_nan=False)] = 28.0


class Patch(Model):
    """Changes some parameters: a JSON merge patch of the state."""

    type: Literal["patch"]
    patch: dict[str, Any]
    id: Id | None = None


class Replace(Model):
    """Replaces the whole state."""

    type: Literal["state"]
    state: dict[str, Any]
    id: Id | None = None


class Resize(Model):
    """The canvas has another size, in device pixels."""

    type: Literal["resize"]
    width: Side
    height: Side


class Ack(Model):
    """A frame was drawn."""

    type: Literal["ack"]
    sequence: Id


class Probe(Model):
    """Asks what lies at a point of the picture; (0, 0) is its top left corner, (1, 1) its bottom right."""

    type: Literal["probe"]
    id: Id
    x: Fraction
    y: Fraction


class Compare(Model):
    """Opens (or, with null, closes) stream 1: the state with this patch."""

    type: Literal["compare"]
    patch: dict[str, Any] | None = None


class Moving(Model):
    """A pointer went down on a control, or up."""

    type: Literal["moving"]
    active: bool


class Cancel(Model):
    """Cancels the running precomputation; the state goes back to the last drawn one."""

    type: Literal["cancel"]


class Ping(Model):
    """Asks for a pong."""

    type: Literal["ping"]
    id: Id


ClientMessage = Annotated[
    Union[Hello, Patch, Replace, Resize, Ack, Probe, Compare, Moving, Cancel, Ping],  # noqa: UP007 - an alias of types
    Field(discriminator="type"),
]
CLIENT: dict[str, type[Model]] = {
    "hello": Hello,
    "patch": Patch,
    "state": Replace,
    "resize": Resize,
    "ack": Ack,
    "probe": Probe,
    "compare": Compare,
    "moving": Moving,
    "cancel": Cancel,
    "ping": Ping,
}


class ServerModel(BaseModel):
    """Base of what the server sends."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Welcome(ServerModel):
    """Answer to hello: the whole state that late joiners need."""

    type: Literal["welcome"] = "welcome"
    protocol: int = PROTOCOL
    session: str
    version: int
    state: dict[str, Any]
    scene: str
    limits: dict[str, int]
    gl: dict[str, Any]


class StateAccepted(ServerModel):
    """The state changed; `id` is that of the message that changed it."""

    type: Literal["state"] = "state"
    version: int
    state: dict[str, Any]
    id: int | None = None


class Refusal(ServerModel):
    """A message was refused, or a picture failed; the state is unchanged."""

    type: Literal["error"] = "error"
    field: str
    message: str
    allowed: str = ""
    id: int | None = None


class BakeProgress(ServerModel):
    """A precomputation advances."""

    type: Literal["progress"] = "progress"
    name: str
    fraction: float
    words: str
    seconds_left: float | None
    cancellable: bool = True


class Ready(ServerModel):
    """The precomputation is over."""

    type: Literal["ready"] = "ready"


class Idle(ServerModel):
    """The last picture was sent; nothing more comes until something changes."""

    type: Literal["idle"] = "idle"
    samples: int


class Pong(ServerModel):
    """Answer to ping."""

    type: Literal["pong"] = "pong"
    id: int


class ProbeResult(BaseModel):
    """What lies at the asked point; beside `id`, the scene's own fields."""

    model_config = ConfigDict(frozen=True, extra="allow")

    type: Literal["probe"] = "probe"
    id: int


ServerMessage = Annotated[
    Union[Welcome, StateAccepted, Refusal, BakeProgress, Ready, Idle, Pong, ProbeResult],  # noqa: UP007 - an alias of types
    Field(discriminator="type"),
]


class FrameHeader(ServerModel):
    """Header of a binary message."""

    sequence: int
    version: int
    stream: Literal[0, 1]
    width: int
    height: int
    codec: Codec
    samples: int
    target_samples: int
    converged: bool
    scale: float
    render_ms: float
    encode_ms: float
    technique: str
    predicted_error: float | None = None


def parse(text: str) -> Model:
    """A client's message.

    Raises:
        InputError, InvalidDocument: what is wrong, naming the field; nothing of the input is echoed.
    """
    try:
        # NaN and Infinity, which JSON has not, are read all the same: the parameter that holds one is named then.
        document = json.loads(text)
    except (ValueError, RecursionError):
        raise InputError("", "the message is not valid JSON") from None
    if not isinstance(document, dict):
        raise InputError("", "the message is not a JSON object", "an object with a field type")
    kind = document.get("type")
    model = CLIENT.get(kind) if isinstance(kind, str) else None
    if model is None:
        raise InputError("type", "there is no such message", ", ".join(CLIENT))
    return validate(model, document)


def finite(value: Any) -> Any:
    """`value` with what JSON cannot hold (NaN, infinities, numpy scalars) made null or plain."""
    if isinstance(value, dict):
        return {str(key): finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(item) for item in value]
    if hasattr(value, "tolist"):
        return finite(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def dump(message: BaseModel) -> str:
    """JSON text of a server's message."""
    return json.dumps(finite(message.model_dump(mode="json")), allow_nan=False, separators=(",", ":"))


def pack(header: FrameHeader, image: bytes) -> bytes:
    """A binary message."""
    text = header.model_dump_json().encode()
    return b"".join((struct.pack("<I", len(text)), text, image))


def unpack(message: bytes) -> tuple[FrameHeader, bytes]:
    """Header and image of a binary message, as clients written in Python read it."""
    (length,) = struct.unpack_from("<I", message)
    return FrameHeader.model_validate_json(message[4 : 4 + length]), message[4 + length :]


def message_schema() -> dict[str, Any]:
    """JSON schema of both directions and of the frame header, which OpenAPI cannot hold."""
    return {
        "protocol": PROTOCOL,
        "path": "/api/session",
        "client": TypeAdapter(ClientMessage).json_schema(),
        "server": TypeAdapter(ServerMessage).json_schema(),
        "frame": {
            "layout": "uint32 little-endian length of the header in bytes, the header as UTF-8 JSON, the image's bytes",
            "header": FrameHeader.model_json_schema(),
        },
    }
