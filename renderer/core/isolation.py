"""What a phenomenon's table of shadow kinds is made of: views that isolate a kind, and the techniques that are held to
it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Isolation:
    """A view in which one kind of shadow dominates.

    Attributes:
        name: of the kind, as the table has it. title: in words.
        switch: what the reference calls it; empty for all kinds at once.
        preset: the view.
    """

    name: str
    title: str
    switch: str
    preset: str


@dataclass(frozen=True)
class Contender:
    """Techniques with parameters, as a row of the table holds them.

    Attributes:
        label: of the row.
        patch: documents of the slots in which it differs from the table's common ones.
        combination: whether it fills every slot as it means to, and answers for its light too.
    """

    label: str
    patch: Mapping[str, Any] = field(default_factory=dict)
    combination: bool = False
