"""Documents against models: validation with errors in words, and changes by path or by patch."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from renderer.core.declaration import choices, facts, models_in, union_members
from renderer.core.errors import InputError, InvalidDocument

M = TypeVar("M", bound=BaseModel)

MOST_ERRORS = 20
"""Errors listed for one document: who made more mistakes reads no further."""

MOST_CHARACTERS = 80
"""Length to which a sender's own words (an unknown field's name) are cut before they are sent back."""

WORDS = {
    "missing": "is required",
    "extra_forbidden": "is not a parameter",
    "literal_error": "is none of the choices",
    "union_tag_invalid": "is none of the kinds",
    "union_tag_not_found": "is required",
    "finite_number": "must be a finite number",
    "greater_than": "is too small",
    "greater_than_equal": "is too small",
    "less_than": "is too large",
    "less_than_equal": "is too large",
    "float_type": "must be a number",
    "float_parsing": "must be a number",
    "int_type": "must be a whole number",
    "int_from_float": "must be a whole number",
    "int_parsing": "must be a whole number",
    "int_parsing_size": "must be a whole number of a reasonable size",
    "bool_type": "must be true or false",
    "bool_parsing": "must be true or false",
    "string_type": "must be text",
    "string_unicode": "must be text",
    "string_too_long": "is too long",
    "string_pattern_mismatch": "is not written as it must be",
    "model_type": "must be an object",
    "model_attributes_type": "must be an object",
    "dict_type": "must be an object",
    "list_type": "must be a list",
    "tuple_type": "must be a list",
    "too_long": "has too many values",
    "too_short": "has too few values",
}
"""Our sentence for each of pydantic's errors, which speak of inputs, tags and instances."""


def validate(model: type[M], document: Any) -> M:
    """Check a document against `model`.

    Raises:
        InvalidDocument: naming every offending field, in words, with what is allowed. Values are never echoed.
    """
    try:
        return model.model_validate(document)
    except ValidationError as failure:
        errors = failure.errors(include_url=False, include_input=False)[:MOST_ERRORS]
        raise InvalidDocument([_in_words(model, dict(error)) for error in errors]) from None
    except InputError as failure:
        raise InvalidDocument([failure]) from None


def told(error: Mapping[str, Any]) -> InputError:
    """An error of pydantic's in our words, where no model is known: of a request to the server.

    Args:
        error: of `errors()` of a request; what was sent is not read.
    """
    if error["type"] == "json_invalid":
        return InputError("", "is not valid JSON")
    context = error.get("ctx", {})
    path = ".".join(_shown(key) for key in error["loc"][1:])
    allowed = str(context.get("expected", "")).replace("'", "").replace(" or ", ", ") or _limit(context)
    return InputError(path, WORDS.get(error["type"], str(error["msg"])), allowed)


def _in_words(model: type[BaseModel], error: dict[str, Any]) -> InputError:
    path, owners, field = _resolve(model, error["loc"])
    kind = error["type"]
    context = error.get("ctx", {})
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        path.append("kind")
        allowed = ", ".join(union_members(field.annotation)) if field is not None else ""
    elif kind == "extra_forbidden":
        allowed = ", ".join(name for owner in owners for name in owner.model_fields)
    elif field is not None and choices(field.annotation):
        allowed = ", ".join(str(choice) for choice in choices(field.annotation))
    else:
        allowed = (_range(field.metadata, facts(field).get("unit", "")) if field is not None else "") or _limit(context)
    if kind == "value_error":
        message = str(context.get("error", error["msg"]))
    else:
        message = WORDS.get(kind, error["msg"])
    return InputError(".".join(_shown(key) for key in path), message, allowed)


def _shown(key: Any) -> str:
    """A part of a path, safe to send back: whole text of a bounded length."""
    return str(key)[:MOST_CHARACTERS].encode("utf-8", "replace").decode()


def _resolve(model: type[BaseModel], loc: tuple[Any, ...]) -> tuple[list[Any], list[type[BaseModel]], FieldInfo | None]:
    """Follow an error's location through the models.

    Returns:
        The path as the document spells it, without the kinds that pydantic inserts after a union; the models that could
        own its last part; and the innermost declared field on the way.
    """
    path: list[Any] = []
    owners: list[type[BaseModel]] = [model]
    field: FieldInfo | None = None
    current: Any = model
    for key in loc:
        members = union_members(current)
        if len(members) > 1 and key in members:
            current = members[key]
            owners = [current]
            continue
        path.append(key)
        if isinstance(key, int) and get_origin(current) is tuple:
            current = get_args(current)[0]
            continue
        owners = models_in(current)
        owner = next((candidate for candidate in owners if key in candidate.model_fields), None)
        if owner is not None:
            field = owner.model_fields[key]
        current = owner.model_fields[key].annotation if owner is not None else None
    return path, owners, field


def _range(limits: list[Any], unit: str) -> str:
    """Both ends of a declared range, in words; the last declared wins."""
    ends: dict[str, str] = {}
    for name, word in (("ge", "at least"), ("gt", "more than"), ("le", "at most"), ("lt", "less than")):
        for limit in limits:
            if getattr(limit, name, None) is not None:
                ends[name[0]] = f"{word} {getattr(limit, name):g}"
    text = ", ".join(ends.values())
    return f"{text} {unit}".strip() if text else ""


def _limit(context: Mapping[str, Any]) -> str:
    """What one violated constraint allows, in words, where the field declares no range."""
    words = {"ge": "at least {:g}", "gt": "more than {:g}", "le": "at most {:g}", "lt": "less than {:g}",
             "max_length": "at most {:d}", "min_length": "at least {:d}", "pattern": "{}", "expected": "{}"}
    return ", ".join(form.format(context[name]) for name, form in words.items() if name in context)


def set_path(document: dict[str, Any], path: str, value: Any) -> dict[str, Any]:
    """A copy of `document` with the value at the dotted `path` replaced; items of lists are named by their numbers.

    Setting a `kind` drops the other fields of that union, which belong to the old kind.

    Raises:
        InputError: an empty path, or one that runs through a value that is no object.
    """
    keys = path.split(".")
    if not all(keys):
        raise InputError(_shown(path), "is not a parameter path", "names joined by dots, as shadow.kind")
    result = dict(document)
    here: Any = result
    for key in keys[:-1]:
        place = _place(here, key, path)
        child = here[place] if isinstance(here, list) else here.get(place, {})
        if not isinstance(child, (dict, list)):
            raise InputError(_shown(path), f"{_shown(key)} has no parameters of its own")
        here[place] = child.copy()
        here = here[place]
    if keys[-1] == "kind" and isinstance(here, dict) and here.get("kind") != value:
        here.clear()
    here[_place(here, keys[-1], path)] = value
    return result


def _place(here: dict[str, Any] | list[Any], key: str, path: str) -> Any:
    """What a part of a path is called in an object, or which item of a list it is."""
    if not isinstance(here, list):
        return key
    if not key.isdecimal() or int(key[:9]) >= len(here):
        raise InputError(_shown(path), f"{_shown(key)} is no item of its list", f"0 to {len(here) - 1}" if here else "")
    return int(key[:9])


def merge(document: dict[str, Any], patch: dict[str, Any]) -> dict[str, Any]:
    """`document` changed by a JSON merge patch (RFC 7396), except that a changed `kind` starts its union afresh.

    A null removes its field, which returns to its default.
    """
    result = dict(document)
    for key, value in patch.items():
        old = result.get(key)
        if value is None:
            result.pop(key, None)
        elif not isinstance(value, dict):
            result[key] = value
        elif isinstance(old, dict) and value.get("kind", old.get("kind")) == old.get("kind"):
            result[key] = merge(old, value)
        else:
            result[key] = merge({}, value)
    return result
