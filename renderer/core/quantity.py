"""What a measurable quantity is: a physical value that people ask for by name, instead of a picture.

A phenomenon lists its own in `renderer/<name>/quantities.py`, as `QUANTITIES`; every door offers them then.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from renderer.core.params import Model

Progress = Callable[[float, str], None]


@dataclass(frozen=True)
class Values:
    """Arrays by name, and what was assumed on the way, in words."""

    arrays: Mapping[str, np.ndarray]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class InputFile:
    """A file that a quantity reads."""

    name: str
    help: str
    required: bool = False


@dataclass(frozen=True)
class Quantity:
    """One measurable quantity.

    Attributes:
        arguments: the declared arguments.
        function: `(arguments, files by name, progress) -> Values`.
        units: unit of each array.
        technique, source: how it is found, and who published it.
        error: estimated error of each array, in words with a unit.
    """

    title: str
    help: str
    arguments: type[Model]
    function: Callable[[Any, Mapping[str, Path], Progress], Values]
    units: Mapping[str, str]
    technique: str
    source: str
    error: Mapping[str, str]
    files: tuple[InputFile, ...] = field(default=())
