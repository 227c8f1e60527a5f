"""Physical quantities instead of pictures: declared once, answered alike by the command line, REST and Python."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from renderer.core.errors import InputError
from renderer.core.params import Model, validate
from renderer.core.quantity import Progress, Quantity
from renderer.study.quantities import known


@dataclass(frozen=True)
class Measurement:
    """What was measured.

    Attributes:
        quantity: its name.
        arrays: the values by name; a name ends in its unit where it has one.
        meta: `units` by array, `technique`, `source`, `estimated_error` by array with its unit, `arguments`, `notes`.
    """

    quantity: str
    arrays: Mapping[str, np.ndarray]
    meta: Mapping[str, Any]

    def as_json(self) -> dict[str, Any]:
        """Arrays as nested lists beside the meta data; JSON has no NaN, so a value that is not finite is null."""
        return {
            "quantity": self.quantity,
            **{name: _plain(values) for name, values in self.arrays.items()},
            "meta": dict(self.meta),
        }

    def save(self, path: Path) -> None:
        """Write a `.json` or an `.npz` (whose `meta` is the JSON text of the meta data).

        Raises:
            InputError: another suffix.
        """
        if path.suffix == ".json":
            path.write_text(json.dumps(self.as_json(), indent=1, allow_nan=False) + "\n", encoding="utf-8")
        elif path.suffix == ".npz":
            with path.open("wb") as file:
                np.savez(file, allow_pickle=False, meta=np.array(json.dumps(dict(self.meta))), **self.arrays)
        else:
            raise InputError("output", f"{path.name} is neither format that holds measurements", ".json or .npz")


def _plain(values: np.ndarray) -> Any:
    if values.dtype.kind != "f":
        return values.tolist()
    plain = values.astype(object)
    plain[~np.isfinite(values)] = None
    return plain.tolist()


def names() -> tuple[str, ...]:
    """The quantities that can be measured."""
    return tuple(known())


def describe(quantity: str) -> dict[str, Any]:
    """Title, help, the JSON schema of the arguments, and the files a quantity reads.

    Raises:
        InputError: there is no such quantity.
    """
    found = _found(quantity)
    return {
        "name": quantity,
        "title": found.title,
        "help": found.help,
        "schema": found.arguments.model_json_schema(),
        "files": [{"name": f.name, "help": f.help, "required": f.required} for f in found.files],
        "units": dict(found.units),
    }


def arguments_model(quantity: str) -> type[Model]:
    """The declared arguments of a quantity.

    Raises:
        InputError: there is no such quantity.
    """
    return _found(quantity).arguments


def measure(
    quantity: str,
    arguments: Mapping[str, Any] | Model,
    files: Mapping[str, Path] | None = None,
    progress: Progress | None = None,
) -> Measurement:
    """Measure one quantity.

    Args:
        quantity: one of `names()`.
        arguments: a document of the quantity's declared arguments, or its model.
        files: paths of the files it reads, by the names that `describe` gives.
        progress: told the share done; may raise `Cancelled`.

    Raises:
        InputError: an unknown quantity, a missing or unknown file, or a file that was refused.
        InvalidDocument: naming every wrong argument.
    """
    found = _found(quantity)
    given = dict(files or {})
    allowed = [f.name for f in found.files]
    for name in given:
        if name not in allowed:
            raise InputError(name, f"{quantity} reads no such file", ", ".join(allowed) or "none")
    for wanted in found.files:
        if wanted.required and wanted.name not in given:
            raise InputError(wanted.name, f"is missing: {wanted.help}")
    document = arguments.model_dump(mode="json") if isinstance(arguments, Model) else dict(arguments)
    checked = validate(found.arguments, document)
    values = found.function(checked, given, progress or _silent)
    meta = {
        "units": dict(found.units),
        "technique": found.technique,
        "source": found.source,
        "estimated_error": dict(found.error),
        "arguments": checked.model_dump(mode="json"),
        "notes": list(values.notes),
    }
    return Measurement(quantity, values.arrays, meta)


def _silent(share: float, words: str) -> None:
    """Progress that nobody listens to."""


def _found(quantity: str) -> Quantity:
    found = known()
    if quantity not in found:
        raise InputError("quantity", "there is no such quantity", ", ".join(found))
    return found[quantity]
