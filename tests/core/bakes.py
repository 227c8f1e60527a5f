"""Bake functions that the tests run in worker processes, which import them from here by name."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from renderer.core.errors import AssetError
from renderer.core.technique import Arrays, Bake

Told = Callable[[float, str], None]


def square(arguments: dict[str, Any], inputs: Mapping[str, Arrays], progress: Told) -> Arrays:
    """The numbers from 0 to `count`, squared; leaves a mark in `marks` each time it really runs."""
    if "marks" in arguments:
        time.sleep(arguments.get("pause_s", 0.0))
        (Path(arguments["marks"]) / f"{os.getpid()}-{time.monotonic_ns()}").touch()
    progress(0.5, "squaring")
    return {"values": np.arange(arguments["count"], dtype=np.float64) ** 2}


def total(arguments: dict[str, Any], inputs: Mapping[str, Arrays], progress: Told) -> Arrays:
    """The sum of its input's values."""
    return {"total": np.asarray(inputs["square"]["values"].sum())}


def endless(arguments: dict[str, Any], inputs: Mapping[str, Arrays], progress: Told) -> Arrays:
    """Reports for ever, until it is told to stop; leaves `ended` behind when it is."""
    try:
        for step in range(100_000):
            progress(step / 100_000, "going round")
            time.sleep(0.01)
    finally:
        Path(arguments["ended"]).touch()
    return {}


def refuse(arguments: dict[str, Any], inputs: Mapping[str, Arrays], progress: Told) -> Arrays:
    """Refuses a user's file."""
    raise AssetError("terrain", "has a hole", "a height in every cell")


def fail(arguments: dict[str, Any], inputs: Mapping[str, Arrays], progress: Told) -> Arrays:
    """Fails by a mistake of its own."""
    raise KeyError("nonsense")


def die(arguments: dict[str, Any], inputs: Mapping[str, Arrays], progress: Told) -> Arrays:
    """Ends its process, as the kernel does when memory runs out."""
    os.kill(os.getpid(), signal.SIGKILL)
    return {}


def bake(function: Callable[..., Arrays], inputs: tuple[Bake, ...] = (), **arguments: Any) -> Bake:
    """A bake named after its function."""
    return Bake(function.__name__, function, arguments, inputs)
