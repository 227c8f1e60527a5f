"""Finds techniques and phenomena by walking folders: adding one edits no shared file."""

from __future__ import annotations

import functools
import importlib
import inspect
import pkgutil
from pathlib import Path
from typing import Annotated, Any, Union

from pydantic import Field

import renderer
from renderer.core.errors import InputError, UmbrageError
from renderer.core.params import kind_of
from renderer.core.quantity import Quantity
from renderer.core.technique import Phenomenon, Technique

SHADERS = Path(renderer.__file__).parent.parent / "shaders"


@functools.cache
def techniques(phenomenon: str, slot: str) -> dict[str, type[Technique]]:
    """Techniques of a slot by kind, in the order of their names.

    Raises:
        UmbrageError: a file whose stem is not its technique's kind, or a technique without its GLSL file.
    """
    package = importlib.import_module(f"renderer.{phenomenon}.{slot}")
    found: dict[str, type[Technique]] = {}
    for module in sorted(m.name for m in pkgutil.iter_modules(package.__path__)):
        loaded = importlib.import_module(f"{package.__name__}.{module}")
        for value in vars(loaded).values():
            if not (inspect.isclass(value) and issubclass(value, Technique) and value.__module__ == loaded.__name__):
                continue
            if kind_of(value) != module:
                raise UmbrageError(f"{loaded.__name__}: its kind is {kind_of(value)!r}, not its file's name")
            if not (SHADERS / glsl_file(phenomenon, slot, module)).is_file():
                raise UmbrageError(f"{loaded.__name__}: no {glsl_file(phenomenon, slot, module)} beside it")
            found[module] = value
    return found


def glsl_file(phenomenon: str, slot: str, kind: str) -> str:
    """Path of a technique's GLSL file, relative to the shader root."""
    return f"{phenomenon}/{slot}/{kind}.glsl"


def slot_union(phenomenon: str, slot: str) -> Any:
    """The discriminated union of a slot's techniques, as a field annotation."""
    members = tuple(techniques(phenomenon, slot).values())
    if len(members) == 1:
        return members[0]
    return Annotated[Union[members], Field(discriminator="kind")]  # noqa: UP007 - built at run time


@functools.cache
def phenomena() -> dict[str, Phenomenon]:
    """Every phenomenon of the checkout by name, in their own order: each package `renderer/<name>/phenomenon.py` with
    its `PHENOMENON`."""
    found = {}
    for entry in sorted(Path(renderer.__file__).parent.iterdir()):
        if (entry / "phenomenon.py").is_file():
            found[entry.name] = importlib.import_module(f"renderer.{entry.name}.phenomenon").PHENOMENON
    return dict(sorted(found.items(), key=lambda item: item[1].place))


def phenomenon(name: str) -> Phenomenon:
    """The phenomenon called `name`.

    Raises:
        InputError: there is none.
    """
    known = phenomena()
    if name not in known:
        raise InputError("scene", "there is no such scene", ", ".join(known))
    return known[name]


@functools.cache
def quantities() -> dict[str, Quantity]:
    """What phenomena let be measured, by name: each `renderer/<name>/quantities.py` with its `QUANTITIES`.

    Raises:
        UmbrageError: two of them give one name to different things.
    """
    found: dict[str, Quantity] = {}
    for entry in sorted(Path(renderer.__file__).parent.iterdir()):
        # The study's own module of that name collects these.
        if entry.name != "study" and (entry / "quantities.py").is_file():
            added = importlib.import_module(f"renderer.{entry.name}.quantities").QUANTITIES
            if twice := found.keys() & added.keys():
                raise UmbrageError(f"renderer.{entry.name}: {', '.join(sorted(twice))} can be measured already")
            found |= added
    return found
