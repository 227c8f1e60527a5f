"""What a declared parameter is: the model it belongs to, its facts, and how to read them back."""

from __future__ import annotations

import types
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, GetCoreSchemaHandler
from pydantic.fields import FieldInfo
from pydantic_core import CoreSchema

Cost = Literal["live", "build", "bake", "host"]
"""What a change of the parameter costs: the next frame, a recompilation, a precomputation, or nothing on the GPU."""

Unit = Literal[
    "", "um", "m", "km", "deg", "s", "h", "m s-1", "m-1", "ratio", "px", "EV", "W m-2", "W m-2 sr-1", "W sr-1", "date",
    "count", "voxel",
]

Component = Annotated[float, Field(allow_inf_nan=False)]
Fraction = Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]
Vector2 = tuple[Component, Component]
Vector3 = tuple[Component, Component, Component]
Colour = tuple[Fraction, Fraction, Fraction]
"""Linear scene-referred reflectance, each channel in [0, 1]."""


def _make_scalars_strict(schema: Any) -> None:
    """Set pydantic's strict mode on the numbers and booleans of a core schema, and on these only."""
    if isinstance(schema, dict):
        if schema.get("type") in ("float", "int", "bool"):
            schema["strict"] = True
        # The rest of a schema is metadata and defaults, which are not to be touched.
        for part in ("schema", "fields", "items_schema", "choices", "definitions"):
            _make_scalars_strict(schema.get(part))
        if schema.get("type") == "model-fields":
            _make_scalars_strict(list(schema["fields"].values()))
    elif isinstance(schema, list):
        for member in schema:
            _make_scalars_strict(member[0] if isinstance(member, tuple) else member)


class Model(BaseModel):
    """Base of everything declared: frozen, closed to unknown fields, without NaN or infinity.

    Neither text nor a boolean passes for a number, nor a number for a boolean. (Pydantic's own strict mode would do
    that too, but refuses the lists of which JSON makes its vectors.)
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, validate_default=True)

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        schema = handler(source)
        _make_scalars_strict(schema)
        return schema


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
    plays: float | None = None,
    takes: tuple[str, ...] = (),
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
        plays: how much it grows in a second where a person lets it run.
        takes: kinds of uploaded files that it may name, where its own name and its parent's do not say them.
    """
    extra: dict[str, Any] = {"unit": unit, "cost": cost}
    if plays is not None:
        extra["plays"] = plays
    if takes:
        extra["takes"] = list(takes)
    if step is not None:
        extra["step"] = step
    if source:
        extra["source"] = source
    limits: dict[str, Any] = {"ge": ge, "le": le, "gt": gt, "lt": lt, "max_length": max_length, "pattern": pattern}
    given = {name: limit for name, limit in limits.items() if limit is not None}
    return Field(default, title=label, description=help, json_schema_extra={"umbrage": extra}, **given)


def facts(field: FieldInfo) -> dict[str, Any]:
    """Unit, cost, step and source of a declared field; empty for one that `param` did not make."""
    extra = field.json_schema_extra
    declared = extra.get("umbrage", {}) if isinstance(extra, dict) else {}
    return dict(declared) if isinstance(declared, dict) else {}


def choices(annotation: Any) -> tuple[Any, ...]:
    """Allowed values of a choice, empty for other parameters."""
    return get_args(annotation) if get_origin(annotation) is Literal else ()


def models_in(annotation: Any) -> list[type[BaseModel]]:
    """The models that a field's annotation admits: several for a union, none for a plain value."""
    origin = get_origin(annotation)
    if origin is Annotated:
        return models_in(get_args(annotation)[0])
    if origin in (Union, types.UnionType):
        return [model for member in get_args(annotation) for model in models_in(member)]
    return [annotation] if isinstance(annotation, type) and issubclass(annotation, BaseModel) else []


def kind_of(model: type[BaseModel]) -> str | None:
    """The `kind` that names a model in its union, or None where it declares none."""
    field = model.model_fields.get("kind")
    return str(get_args(field.annotation)[0]) if field is not None else None


def union_members(annotation: Any) -> dict[str, type[BaseModel]]:
    """Models of a discriminated union by their `kind`."""
    return {kind: model for model in models_in(annotation) if (kind := kind_of(model)) is not None}
