"""Parameters, declared once.

A field of a model made with `param` carries its unit, range, default, label, help, source and what a change costs.
Validation, the JSON schema, the page's control, the GLSL declaration and its upload all follow from it.
Documents hold angles in degrees; GLSL and Python receive radians (`radians_of`, `uniforms`).
"""

from __future__ import annotations

import math
import types
import typing
from collections.abc import Iterator
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pydantic.fields import FieldInfo

from renderer.core.errors import InputError, InvalidDocument

Cost = Literal["live", "build", "bake", "host"]
"""What a change of the parameter costs: the next frame, a recompilation, a precomputation, or nothing on the GPU."""

Unit = Literal["", "m", "km", "deg", "s", "h", "m-1", "ratio", "px", "EV", "W m-2", "date", "count", "voxel"]

Component = Annotated[float, Field(allow_inf_nan=False)]
Vector2 = tuple[Component, Component]
Vector3 = tuple[Component, Component, Component]
Colour = tuple[Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)],
               Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)],
               Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]]
"""Linear scene-referred reflectance, each channel in [0, 1]."""

GLSL_TYPES: dict[Any, str] = {float: "float", int: "int", bool: "bool", Vector2: "vec2", Vector3: "vec3", Colour: "vec3"}


class Model(BaseModel):
    """Base of everything declared: frozen, closed to unknown fields, strict about numbers."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, validate_default=True)


def param(
    default: Any,
    *,
    label: str,
    help: str,  # noqa: A002 - the field's own word
    unit: Unit = "",
    cost: Cost = "live",
    ge: float | None = None,
    le: float | None = None,
    gt: float | None = None,
    lt: float | None = None,
    step: float | None = None,
    source: str = "",
    max_length: int | None = None,
    pattern: str | None = None,
) -> Any:
    """Declare one parameter.

    Args:
        default: its default value (or a model instance for a nested one).
        label: short name shown to people.
        help: one sentence, without the unit or the range.
        unit: SI unit of the document's value; angles are degrees there.
        cost: what a change costs.
        ge, le, gt, lt: range of the value, in `unit`.
        step: suggested increment of a control.
        source: author, year, section or equation.
        max_length, pattern: limits of a text value.
    """
    extra = {"unit": unit, "cost": cost}
    if step is not None:
        extra["step"] = step  # type: ignore[assignment]
    if source:
        extra["source"] = source
    limits = {k: v for k, v in {"ge": ge, "le": le, "gt": gt, "lt": lt, "max_length": max_length, "pattern": pattern}.items() if v is not None}
    return Field(default, title=label, description=help, json_schema_extra={"umbrage": extra}, **limits)  # type: ignore[arg-type]


def facts(field: FieldInfo) -> dict[str, Any]:
    """Unit, cost, step and source of a declared field."""
    extra = field.json_schema_extra
    declared = extra.get("umbrage", {}) if isinstance(extra, dict) else {}
    return dict(declared) if isinstance(declared, dict) else {}


def glsl_type(annotation: Any) -> str | None:
    """GLSL type of a parameter's annotation, or None where it has none (text, nested models)."""
    if annotation in GLSL_TYPES:
        return GLSL_TYPES[annotation]
    if get_origin(annotation) is Literal:
        return "int"
    return None


def choices(annotation: Any) -> tuple[Any, ...]:
    """Allowed values of a choice, empty for other parameters."""
    return get_args(annotation) if get_origin(annotation) is Literal else ()


def _declared(model: type[BaseModel], cost: Cost) -> Iterator[tuple[str, FieldInfo, str]]:
    for name, field in model.model_fields.items():
        kind = glsl_type(field.annotation)
        if name != "kind" and kind is not None and facts(field).get("cost") == cost:
            yield name, field, kind


def uniform_declarations(model: type[BaseModel], prefix: str) -> str:
    """GLSL text declaring the live parameters of `model` as `uniform TYPE prefix_name;`, with units as comments."""
    lines = []
    for name, field, kind in _declared(model, "live"):
        unit = "rad" if facts(field)["unit"] == "deg" else facts(field)["unit"]
        lines.append(f"uniform {kind} {prefix}_{name};" + (f" // {unit}" if unit else ""))
    return "\n".join(lines)


def radians_of(model: BaseModel, name: str) -> float:
    """Value of an angle parameter in radians (documents hold degrees)."""
    return math.radians(getattr(model, name))


def uniforms(model: BaseModel, prefix: str) -> dict[str, Any]:
    """Values to upload for `uniform_declarations`: angles in radians, choices as their index."""
    values: dict[str, Any] = {}
    for name, field, _ in _declared(type(model), "live"):
        value = getattr(model, name)
        if facts(field)["unit"] == "deg":
            value = math.radians(value)
        elif choices(field.annotation):
            value = choices(field.annotation).index(value)
        values[f"{prefix}_{name}"] = value
    return values


def defines(model: BaseModel, prefix: str) -> dict[str, str]:
    """`#define` lines for the build parameters: upper-case names, choices also as named constants."""
    lines: dict[str, str] = {}
    for name, field, kind in _declared(type(model), "build"):
        value = getattr(model, name)
        key = f"{prefix}_{name}".upper()
        options = choices(field.annotation)
        if options:
            for index, option in enumerate(options):
                lines[f"{key}_{str(option).upper().replace('-', '_')}"] = str(index)
            value = options.index(value)
        if isinstance(value, bool):
            value = int(value)
        lines[key] = repr(float(value)) if kind == "float" else str(value)
    return lines


def bake_arguments(model: BaseModel) -> dict[str, Any]:
    """The bake parameters of `model` (nested models whole), as plain JSON values: part of a cache key."""
    return {name: value for name, value in model.model_dump(mode="json").items()
            if name == "kind" or facts(type(model).model_fields[name]).get("cost") == "bake"}


def _allowed(error: Any) -> str:
    context = error.get("ctx", {}) or {}
    words = {"ge": "at least", "gt": "more than", "le": "at most", "lt": "less than"}
    parts = [f"{words[key]} {context[key]:g}" for key in words if isinstance(context.get(key), (int, float))]
    if "expected" in context:
        parts.append(str(context["expected"]))
    if "expected_tags" in context:
        parts.append(str(context["expected_tags"]))
    return ", ".join(parts)


def _range_of(model: type[BaseModel], path: tuple[Any, ...]) -> str:
    """Both ends of the declared range of the field at `path`, in words."""
    field: FieldInfo | None = None
    current: Any = model
    for key in path:
        options = [option for option in _models_in(current)]
        named = [o for o in options if key == _kind_of(o)]
        if named:
            current = named[0]
            continue
        owner = next((o for o in options if key in o.model_fields), None)
        if owner is None:
            break
        field = owner.model_fields[key]
        current = field.annotation
    if field is None:
        return ""
    low = high = ""
    for item in field.metadata:
        for name, word in (("ge", "at least"), ("gt", "more than")):
            if getattr(item, name, None) is not None:
                low = f"{word} {getattr(item, name):g}"
        for name, word in (("le", "at most"), ("lt", "less than")):
            if getattr(item, name, None) is not None:
                high = f"{word} {getattr(item, name):g}"
    unit = facts(field).get("unit", "")
    text = ", ".join(part for part in (low, high) if part)
    return f"{text} {unit}".strip() if text else ""


def _models_in(annotation: Any) -> list[type[BaseModel]]:
    origin = get_origin(annotation)
    if origin is Annotated:
        return _models_in(get_args(annotation)[0])
    if origin in (Union, types.UnionType):
        return [m for arg in get_args(annotation) for m in _models_in(arg)]
    return [annotation] if isinstance(annotation, type) and issubclass(annotation, BaseModel) else []


def _kind_of(model: type[BaseModel]) -> str | None:
    field = model.model_fields.get("kind")
    return get_args(field.annotation)[0] if field is not None else None


def union_members(annotation: Any) -> dict[str, type[BaseModel]]:
    """Models of a discriminated union by their `kind`."""
    return {kind: m for m in _models_in(annotation) if (kind := _kind_of(m)) is not None}


M = typing.TypeVar("M", bound=BaseModel)


def validate(model: type[M], document: Any) -> M:
    """Check a document against `model`.

    Raises:
        InvalidDocument: naming every offending field, in words, with what is allowed. The input is never echoed.
    """
    try:
        return model.model_validate(document)
    except ValidationError as failure:
        found = []
        for error in failure.errors(include_url=False, include_input=False):
            path = error["loc"]
            field = ".".join(str(key) for key in _without_tags(model, path))
            found.append(InputError(field, error["msg"], _range_of(model, path) or _allowed(error)))
        raise InvalidDocument(found) from None


def _without_tags(model: type[BaseModel], path: tuple[Any, ...]) -> list[Any]:
    """An error's path without the union tags that pydantic inserts."""
    kept: list[Any] = []
    current: Any = model
    for key in path:
        options = _models_in(current)
        if any(key == _kind_of(o) for o in options) and not any(key in o.model_fields for o in options):
            current = next(o for o in options if key == _kind_of(o))
            continue
        kept.append(key)
        owner = next((o for o in options if key in o.model_fields), None)
        current = owner.model_fields[key].annotation if owner else None
    return kept


def set_path(document: dict[str, Any], path: str, value: Any) -> dict[str, Any]:
    """A copy of `document` with the value at the dotted `path` replaced.

    Setting a `kind` drops the other fields of that union, which belong to the old kind.

    Raises:
        InputError: an empty path, or one that runs through a value that is no object.
    """
    keys = path.split(".")
    if not all(keys):
        raise InputError(path, "is not a parameter path", "names joined by dots, as shadow.kind")
    result = dict(document)
    here = result
    for key in keys[:-1]:
        child = here.get(key, {})
        if not isinstance(child, dict):
            raise InputError(path, f"{key} has no parameters of its own")
        here[key] = dict(child)
        here = here[key]
    if keys[-1] == "kind" and here.get("kind") != value:
        here.clear()
    here[keys[-1]] = value
    return result


def merge(document: dict[str, Any], patch: dict[str, Any]) -> dict[str, Any]:
    """JSON merge patch that starts a union afresh when its `kind` changes."""
    result = dict(document)
    for key, value in patch.items():
        old = result.get(key)
        if isinstance(value, dict) and isinstance(old, dict) and value.get("kind", old.get("kind")) == old.get("kind"):
            result[key] = merge(old, value)
        else:
            result[key] = value
    return result
