"""Parameters, declared once.

A field of a model made with `param` carries its unit, range, default, label, help, source and what a change costs.
Validation, the JSON schema, the page's control, the GLSL declaration and its upload all follow from it.
Documents hold angles in degrees; GLSL and Python receive radians (`radians_of`, `uniforms`).

This module is the one to import: how a parameter is declared (`declaration`), how documents are checked and changed
(`documents`), and, here, what becomes of a parameter outside the document.
"""

from __future__ import annotations

import functools
import math
import re
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from renderer.core.declaration import (
    Colour,
    Cost,
    Model,
    Unit,
    Vector2,
    Vector3,
    choices,
    facts,
    kind_of,
    models_in,
    param,
    union_members,
)
from renderer.core.documents import merge, set_path, validate

__all__ = [
    "Colour", "Cost", "Model", "Unit", "Vector2", "Vector3", "bake_arguments", "choices", "defines", "facts",
    "glsl_type", "kind_of", "merge", "models_in", "param", "radians_of", "set_path", "uniform_declarations", "uniforms",
    "union_members", "validate",
]

GLSL_TYPES: dict[Any, str] = {
    float: "float", int: "int", bool: "bool", Vector2: "vec2", Vector3: "vec3", Colour: "vec3",
}


def glsl_type(annotation: Any) -> str | None:
    """GLSL type of a parameter's annotation, or None where it has none (text, nested models)."""
    return "int" if choices(annotation) else GLSL_TYPES.get(annotation)


def radians_of(model: BaseModel, name: str) -> float:
    """Value of an angle parameter in radians (documents hold degrees)."""
    return math.radians(getattr(model, name))


def uniform_declarations(model: type[BaseModel], prefix: str) -> str:
    """GLSL text declaring the live parameters of `model` as `uniform TYPE prefix_name;`, with units as comments.

    A choice among words also gets a constant for each, `prefix_name_word`, to compare the uniform with.
    """
    lines = []
    for name, field, kind in _declared(model, "live"):
        unit = "rad" if facts(field)["unit"] == "deg" else facts(field)["unit"]
        lines.append(f"uniform {kind} {prefix}_{name};" + (f" // {unit}" if unit else ""))
        for index, word in enumerate(_named(field)):
            lines.append(f"const int {prefix}_{name}_{word} = {index};")
    return "\n".join(lines)


def uniforms(model: BaseModel, prefix: str) -> dict[str, Any]:
    """Values to upload for `uniform_declarations`: angles in radians, words as their index."""
    return {f"{prefix}_{name}": _value(model, name, field) for name, field, _ in _declared(type(model), "live")}


def defines(model: BaseModel, prefix: str) -> dict[str, str]:
    """`#define` names and texts of the build parameters, in upper case; angles in radians, words as their index.

    A choice among words also gets a constant for each, `PREFIX_NAME_WORD`.
    """
    lines: dict[str, str] = {}
    for name, field, kind in _declared(type(model), "build"):
        key = f"{prefix}_{name}".upper()
        for index, word in enumerate(_named(field)):
            lines[f"{key}_{word.upper()}"] = str(index)
        lines[key] = _literal(_value(model, name, field), kind)
    return lines


def bake_arguments(model: BaseModel) -> dict[str, Any]:
    """The bake parameters of `model` (nested models whole), as plain JSON values: part of a cache key."""
    return {name: value for name, value in model.model_dump(mode="json").items()
            if name == "kind" or facts(type(model).model_fields[name]).get("cost") == "bake"}


@functools.cache
def _declared(model: type[BaseModel], cost: Cost) -> tuple[tuple[str, FieldInfo, str], ...]:
    kinds = ((name, field, glsl_type(field.annotation)) for name, field in model.model_fields.items() if name != "kind")
    return tuple((name, field, kind) for name, field, kind in kinds if kind and facts(field).get("cost") == cost)


def _named(field: FieldInfo) -> list[str]:
    """The words of a choice as identifiers; a choice among numbers needs none."""
    return [re.sub(r"\W", "_", choice) for choice in choices(field.annotation) if isinstance(choice, str)]


def _value(model: BaseModel, name: str, field: FieldInfo) -> Any:
    """A parameter's value as GLSL takes it."""
    value = getattr(model, name)
    if _named(field):
        return choices(field.annotation).index(value)
    if facts(field)["unit"] == "deg":
        return tuple(map(math.radians, value)) if isinstance(value, tuple) else math.radians(value)
    return value


def _literal(value: Any, kind: str) -> str:
    """A value as GLSL text."""
    if isinstance(value, tuple):
        return f"{kind}({', '.join(repr(float(component)) for component in value)})"
    if kind == "float":
        return repr(float(value))
    return str(int(value))
