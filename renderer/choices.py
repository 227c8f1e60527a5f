"""Techniques with parameters, as a command names them: `kind:name=value:name=value`."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from renderer.core.errors import InputError
from renderer.core.registry import techniques


@dataclass(frozen=True)
class Choice:
    """A technique of the slot that is studied, with parameters.

    Attributes:
        label: as it was asked for.
        kind: of the technique. parameters: by name, JSON values.
    """

    label: str
    kind: str
    parameters: Mapping[str, Any] = field(default_factory=dict)


def choices_of(scene: str, slot: str, text: str) -> tuple[Choice, ...]:
    """Techniques from text: `kind`, or `kind:name=value:name=value`, separated by commas; all kinds where it is empty.

    Raises:
        InputError: a technique that the slot has not, or a parameter without a value.
    """
    kinds = tuple(techniques(scene, slot))
    found = []
    for label in filter(None, text.split(",")) if text else kinds:
        kind, *pairs = label.split(":")
        if kind not in kinds:
            raise InputError("techniques", f"{slot} has no technique {kind}", ", ".join(kinds))
        if not all(re.fullmatch(r"\w+=.+", pair) for pair in pairs):
            raise InputError("techniques", f"{label} is not understood", "kind, or kind:parameter=value:..")
        values = dict(pair.split("=", 1) for pair in pairs)
        found.append(Choice(label, kind, {name: plain(value) for name, value in values.items()}))
    return tuple(found)


def plain(text: str) -> Any:
    """A value of a parameter from text: a truth value, a number, or a word."""
    if text in ("true", "false"):
        return text == "true"
    for read_as in (int, float):
        try:
            return read_as(text)
        except ValueError:
            continue
    return text
