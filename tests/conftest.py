"""What every test stands on: numpy errors raise, and nothing is written outside the test's own folder."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from xdist.scheduler import LoadScopeScheduling

# Set before any test module is imported, so that worker processes inherit it too.
os.environ.setdefault("UMBRAGE_CACHE", str(Path(tempfile.gettempdir()) / f"umbrage-tests-{os.getuid()}"))

# Processes that share the tests have a core each; in each, Mesa's rasteriser would start a thread for every core.
if "PYTEST_XDIST_WORKER" in os.environ:
    os.environ.setdefault("LP_NUM_THREADS", "1")


def pytest_addoption(parser: pytest.Parser) -> None:
    """What only some tests read must be known before any is found."""
    parser.addoption("--regenerate", action="store_true", help="put what was found in the place of frozen references")


class ByFile(LoadScopeScheduling):
    """Hands whole files to the processes among which `make test` shares the tests, in the order of their names.

    Those of the browser, the first and longest, stay together: they share a server and a browser, and one process can
    wait for these while another computes.
    """

    def _split_scope(self, nodeid: str) -> str:
        """What is handed over at once."""
        return "browser" if nodeid.startswith("tests/browser/") else nodeid.split("::", 1)[0]


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> ByFile:
    """Asked where tests run in several processes."""
    return ByFile(config, log)


@pytest.fixture(autouse=True)
def numpy_errors_raise() -> Iterator[None]:
    """A division by zero, an overflow or an invalid operation in the code under test is a failure."""
    with np.errstate(divide="raise", over="raise", invalid="raise"):
        yield


@pytest.fixture
def root() -> Path:
    """Folder of the checkout."""
    return Path(__file__).parent.parent


@pytest.fixture
def spoil(monkeypatch: pytest.MonkeyPatch) -> Callable[[str, str, str], AbstractContextManager[None]]:
    """Makes a mistake in a shader while entered: `with spoil(file, right, wrong): ...`."""
    # Imported here, so that tests without shaders need not wait for them.
    from renderer.clouds import program as clouds
    from renderer.directional import program as directional
    from renderer.forest import program as forest
    from renderer.gl import source
    from renderer.shells import program as shells

    forests = forest._composed, forest.pass_source
    composed = (source.stage, clouds.composed, *forests, shells.composed, directional.composed)

    @contextmanager
    def spoiled(file: str, right: str, wrong: str) -> Iterator[None]:
        read = source._read

        def reads(root: Any, name: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
            raw, clean = read(root, name)
            if name != file:
                return raw, clean
            text = "\n".join(raw)
            assert text.count(right) == 1, f"{file} has not exactly one {right!r}"
            lines = tuple(text.replace(right, wrong).split("\n"))
            return lines, tuple("" if line.lstrip().startswith("//") else line for line in lines)

        with monkeypatch.context() as patch:
            patch.setattr(source, "_read", reads)
            for kept in composed:
                kept.cache_clear()
            yield
        for kept in composed:
            kept.cache_clear()

    return spoiled
