"""The picture in parts: what a ray shows decides where each is drawn, and their sum is the whole picture."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from renderer.clouds import frame_passes
from renderer.core.registry import SHADERS
from renderer.session import Session

SIZE = (48, 32)
WORLD = {"quality.kind": "draft", "phase.kind": "henyey_greenstein", "scattering.kind": "delta_eddington",
         "bounce.kind": "none"}


@pytest.fixture(scope="module")
def session() -> Iterator[Session]:
    with Session() as opened:
        yield opened


def picture(session: Session, preset: str, **given: Any) -> np.ndarray:
    """Radiance of a preset, (32, 48, 4) W m-2 sr-1."""
    state = session.state("clouds", preset, {**WORLD, **given})
    session.prepare(state).future.result()
    for drawer in session._painter._renderers.values():
        session.gl.call(lambda gl, drawer=drawer: drawer._stretches.release())  # what a spoiled shader traced
    return session.render(state, *SIZE).linear.astype(float)


def test_python_and_the_shader_name_what_is_shown_alike() -> None:
    text = (SHADERS / "clouds/frame.glsl").read_text()
    for name in ("SKY", "GROUND", "FAR", "FAR_THROUGH", "GROUND_THROUGH", "SKY_THROUGH", "CLOUD", "ALL"):
        assert f"SHOWS_{name} = {getattr(frame_passes, name)}.0" in text


def test_what_a_cloud_hides_need_not_be_drawn(session: Session, spoil: Callable) -> None:
    """A picture with all drawn that is hidden is the same; one without what half a cloud hides is not."""
    found = picture(session, "fogbow")
    with spoil("clouds/frame.glsl", "const float HIDDEN = 1.0e-4", "const float HIDDEN = -1.0"):
        whole = picture(session, "fogbow")
    with spoil("clouds/frame.glsl", "const float HIDDEN = 1.0e-4", "const float HIDDEN = 0.5"):
        cut = picture(session, "fogbow")
    scale = whole[..., :3].mean()
    assert np.abs(found - whole)[..., :3].max() < 1e-3 * scale
    assert np.abs(cut - whole)[..., :3].max() > 2e-2 * scale


def test_every_pixel_is_covered_once(session: Session) -> None:
    sky, none = picture(session, "fogbow"), picture(session, "fogbow", **{"view.background": "none"})
    assert (sky[..., 3] == 1).all()
    assert none[..., 3].min() < 0.9
    assert none[..., 3].max() == pytest.approx(1, abs=1e-3)
    np.testing.assert_allclose(none[..., :3], sky[..., :3], rtol=1e-5)
