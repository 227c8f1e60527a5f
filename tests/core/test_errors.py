"""Errors read as sentences, and survive the way back from a worker process."""

from __future__ import annotations

import pickle

import pytest

from renderer.core.errors import (
    AssetError,
    Cancelled,
    InputError,
    InvalidDocument,
    LimitError,
    ShaderError,
    UmbrageError,
)


@pytest.mark.parametrize(("error", "sentence"), [
    (InputError("sun.azimuth", "is too large", "at most 360 deg"),
     "sun.azimuth: is too large (allowed: at most 360 deg)"),
    (AssetError("terrain", "has a hole"), "terrain: has a hole"),
    (LimitError("", "too much"), "too much"),
    (InvalidDocument([InputError("a", "b"), InputError("c", "d")]), "a: b; c: d"),
    (ShaderError("lib/sky.glsl", 12, "undeclared"), "lib/sky.glsl:12: undeclared"),
    (Cancelled("enough"), "enough"),
])
def test_reads_as_a_sentence_here_and_after_pickling(error: UmbrageError, sentence: str) -> None:
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is type(error)
    assert str(again) == str(error) == sentence
    assert {name: str(value) for name, value in vars(again).items()} == {
        name: str(value) for name, value in vars(error).items()}
