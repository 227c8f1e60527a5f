"""What one user waits for never waits for another's long work."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest

from renderer.core.cache import Cache
from renderer.core.channel import Progress
from renderer.core.errors import Cancelled
from renderer.session import Session
from renderer.world.state import SceneState
from tests.core.bakes import bake, endless, square

WAIT_S = 60.0


def test_a_view_s_bake_does_not_wait_for_a_reference(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begun, over, ended = threading.Event(), threading.Event(), threading.Event()

    def heard(progress: Progress) -> None:
        begun.set()
        if over.is_set():
            raise Cancelled("enough")

    with Session(cache=Cache(tmp_path)) as session:

        def long() -> None:
            with pytest.raises(Cancelled):
                session.compute(bake(endless, ended=str(tmp_path / "ended")), heard)
            ended.set()

        threading.Thread(target=long).start()
        assert begun.wait(WAIT_S)
        monkeypatch.setattr(session, "_bakes", lambda state: [bake(square, count=3)])
        session.prepare(SceneState()).future.result(WAIT_S)
        assert not ended.is_set()
        over.set()
        assert ended.wait(WAIT_S)
