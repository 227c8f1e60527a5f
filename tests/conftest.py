"""What every test stands on: numpy errors raise, and nothing is written outside the test's own folder."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

# Set before any test module is imported, so that worker processes inherit it too.
os.environ.setdefault("UMBRAGE_CACHE", str(Path(tempfile.gettempdir()) / f"umbrage-tests-{os.getuid()}"))


def pytest_addoption(parser: pytest.Parser) -> None:
    """What only some tests read must be known before any is found."""
    parser.addoption("--regenerate", action="store_true", help="put what was found in the place of frozen references")


@pytest.fixture(autouse=True)
def numpy_errors_raise() -> Iterator[None]:
    """A division by zero, an overflow or an invalid operation in the code under test is a failure."""
    with np.errstate(divide="raise", over="raise", invalid="raise"):
        yield


@pytest.fixture
def root() -> Path:
    """Folder of the checkout."""
    return Path(__file__).parent.parent
