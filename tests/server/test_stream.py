from __future__ import annotations

import time
from typing import Any

import numpy as np
from starlette.testclient import TestClient

from server.app import create_app
from server.protocol import FrameHeader
from server.settings import Settings
from tests.server.fake_session import FakeSession, FakeState, paint
from tests.server.talk import Talk, pixels


def test_a_hello_is_welcomed_refined_and_then_there_is_silence(client: TestClient, hello: dict[str, Any]) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        talk.send(**hello)
        welcome = talk.until("welcome")
        assert welcome["protocol"] == 1
        assert welcome["state"] == FakeState(brightness=0.75).model_dump(mode="json"), "its first preset"
        assert welcome["limits"]["max_side"] == 4096
        assert welcome["gl"] == {"renderer": "fake", "software": True}
        assert talk.until("idle")["samples"] == 64
        headers = [header for header, _ in talk.frames]
        assert [header.samples for header in headers] == [1, 2, 4, 8, 16, 32, 64]
        assert headers[-1].codec == "png"
        assert headers[-1].converged
        assert {header.codec for header in headers[:-1]} == {"jpeg"}
        assert np.array_equal(pixels(talk.frames[-1][1]), paint(FakeState(brightness=0.75), 64, 48))
        assert talk.silent(0.3)


def test_a_patch_is_drawn_with_its_version_and_its_id_comes_back(client: TestClient, hello: dict[str, Any]) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        talk.send(**hello)
        talk.until("idle")
        talk.frames.clear()
        talk.send(type="patch", patch={"brightness": 0.9, "quality": {"kind": "draft"}}, id=7)
        accepted = talk.until("state")
        assert (accepted["id"], accepted["version"], accepted["state"]["brightness"]) == (7, 2, 0.9)
        talk.until("idle")
        assert {header.version for header, _ in talk.frames} == {2}
        assert np.array_equal(pixels(talk.frames[-1][1]), paint(FakeState(brightness=0.9), 64, 48))


def test_without_acknowledgement_two_frames_come_and_no_third(client: TestClient, hello: dict[str, Any]) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket, acknowledging=False)
        talk.send(**hello)
        assert [talk.frame().sequence, talk.frame().sequence] == [1, 2]
        for step in range(20):
            talk.send(type="patch", patch={"brightness": 0.5 + step / 50}, id=step)
        for _ in range(20):
            talk.until("state")
        assert talk.silent(0.3)
        talk.send(type="ack", sequence=2)
        header = talk.frame()
        assert header.version == 21, "the newest state overtakes what was never drawn"


def test_an_acknowledgement_of_frames_never_sent_opens_nothing(client: TestClient, hello: dict[str, Any]) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket, acknowledging=False)
        talk.send(**hello)
        talk.send(type="ack", sequence=10**9)
        assert [talk.frame().sequence, talk.frame().sequence] == [1, 2]
        talk.send(type="ack", sequence=1)
        assert talk.frame().sequence == 3
        assert talk.silent(0.2)


def test_while_moving_the_resolution_falls_and_at_rest_it_is_full(
    client: TestClient, session: FakeSession, hello: dict[str, Any]
) -> None:
    session.draw_seconds = 0.06
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        talk.send(**{**hello, "width": 64, "height": 64, "frame_ms": 20})
        talk.until("welcome")
        talk.send(type="patch", patch={"quality": {"kind": "draft"}}, id=0)
        talk.send(type="moving", active=True)
        scales = []
        for step in range(1, 13):
            talk.send(type="patch", patch={"brightness": 0.5 + step / 50}, id=step)
            header = talk.frame()
            while header.version < step + 2:
                header = talk.frame()
            scales.append(header.scale)
        assert min(scales) >= 0.5
        assert scales[-1] < 0.7, "60 ms at full size is 20 ms at 0.58"
        assert header.width == round(64 * header.scale)
        talk.send(type="moving", active=False)
        talk.until("idle")
        assert (talk.frames[-1][0].scale, talk.frames[-1][0].width) == (1.0, 64)


def test_two_streams_compare(client: TestClient, hello: dict[str, Any]) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        talk.send(**{**hello, "state": {"scene": "fake", "quality": {"kind": "samples", "n": 2}}})
        talk.until("idle")
        talk.send(type="compare", patch={"brightness": 1.0})
        talk.until("idle")
        beside = [image for header, image in talk.frames if header.stream == 1][-1]
        assert np.array_equal(pixels(beside), paint(FakeState(brightness=1.0), 64, 48))
        talk.frames.clear()
        talk.send(type="patch", patch={"density": 1, "time": 3.0}, id=1)
        talk.until("idle")
        assert {header.stream for header, _ in talk.frames} == {0, 1}
        assert {header.version for header, _ in talk.frames} == {2}
        talk.send(type="compare", patch=None)
        talk.frames.clear()
        talk.send(type="patch", patch={"time": 4.0}, id=2)
        talk.until("idle")
        assert {header.stream for header, _ in talk.frames} == {0}


def test_a_resize_redraws_at_the_new_size(client: TestClient, hello: dict[str, Any]) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        talk.send(**hello)
        talk.until("idle")
        talk.send(type="resize", width=32, height=16)
        talk.until("idle")
        assert pixels(talk.frames[-1][1]).shape == (16, 32, 3)
        talk.send(type="resize", width=7000, height=7000)
        refused = talk.until("error")
        assert refused["field"] == "width"
        assert "4096" in refused["allowed"]
        assert talk.silent(0.1)


def test_views_with_more_pixels_than_all_may_have_are_refused_until_one_closes(
    session: FakeSession, settings: Settings, hello: dict[str, Any]
) -> None:
    app = create_app(session, settings.model_copy(update={"max_live_pixels": 6000}))
    with (
        TestClient(app, base_url="http://127.0.0.1:8000") as client,
        client.websocket_connect("/api/session") as first,
        client.websocket_connect("/api/session") as second,
    ):
        one, other = Talk(first), Talk(second)
        one.send(**hello)
        one.until("idle")
        other.send(**hello)
        refused = other.until("error")
        assert refused["field"] == "width"
        assert refused["allowed"].startswith(f"{6000 - 64 * 48} pixels")
        one.send(type="resize", width=70, height=80)
        one.send(type="resize", width=80, height=80)
        assert "together" in one.until("error")["message"]
        one.send(type="resize", width=30, height=30)
        one.until("idle")
        other.send(**hello)
        other.until("welcome")


def test_a_large_picture_comes_coarse_at_first_then_as_jpeg_and_then_without_loss(
    client: TestClient, hello: dict[str, Any]
) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        talk.send(**{**hello, "width": 640, "height": 480, "state": {"scene": "fake", "quality": {"kind": "draft"}}})
        talk.until("idle")
        seen = [(header.codec, header.scale, header.width) for header, _ in talk.frames]
        assert seen == [("jpeg", 0.5, 320), ("jpeg", 1.0, 640), ("png", 1.0, 640)]


def test_a_slow_picture_is_shown_coarsely_first_and_a_quick_one_is_not(
    client: TestClient, session: FakeSession, hello: dict[str, Any]
) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        talk.send(**{**hello, "width": 64, "height": 64, "state": {"scene": "fake", "quality": {"kind": "draft"}}})
        talk.until("idle")
        assert [header.scale for header, _ in talk.frames] == [1.0], "a small canvas shows its first picture whole"
        session.draw_seconds = 0.2
        talk.send(type="resize", width=60, height=60)
        talk.until("idle")
        talk.frames.clear()
        session.bake_gate.clear()
        talk.send(type="patch", patch={"density": 5}, id=1)
        talk.until("progress")
        time.sleep(0.5)  # the movement that a patch begins is over long before its precomputation
        session.bake_gate.set()
        talk.until("idle")
        assert [header.scale for header, _ in talk.frames] == [0.5, 1.0]


def test_while_another_view_moves_a_picture_is_refined_a_fifth_of_the_time(
    client: TestClient, session: FakeSession, hello: dict[str, Any]
) -> None:
    def samples_during(moving: bool) -> int:
        with client.websocket_connect("/api/session") as still, client.websocket_connect("/api/session") as busy:
            refined, moved = Talk(still), Talk(busy)
            refined.send(**{**hello, "state": {"scene": "fake", "quality": {"kind": "samples", "n": 4096}}})
            moved.send(**{**hello, "state": {"scene": "fake", "quality": {"kind": "draft"}}})
            moved.until("idle")
            if moving:
                moved.send(type="moving", active=True)
            start, step = time.monotonic(), 0
            before = len(session.drawn)
            while time.monotonic() - start < 0.8:
                step += 1
                for talk in (refined, moved):
                    talk.send(type="ack", sequence=10**6)  # all that was sent
                if moving:
                    moved.send(type="patch", patch={"brightness": 0.5 + (step % 40) / 100}, id=step)
                time.sleep(0.02)
            return sum(state.quality.kind == "samples" for state, *_ in session.drawn[before:])

    session.draw_seconds = 0.005
    assert samples_during(moving=True) < 0.5 * samples_during(moving=False)


def test_a_client_without_png_ends_with_jpeg(client: TestClient, hello: dict[str, Any]) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        talk.send(**{**hello, "codecs": ["jpeg"]})
        talk.until("idle")
        assert {header.codec for header, _ in talk.frames} == {"jpeg"}


def test_a_probe_answers_with_its_id_and_without_nan(client: TestClient, hello: dict[str, Any]) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        talk.send(**hello)
        talk.until("idle")
        talk.send(type="probe", id=5, x=0.5, y=0.25)
        assert talk.until("probe") == {"type": "probe", "id": 5, "elevation": 50.0, "radiance": [None, 1.0], "y": 0.25}


def test_the_same_state_again_shows_its_version_without_drawing(
    client: TestClient, session: FakeSession, hello: dict[str, Any]
) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        talk.send(**hello)
        talk.until("idle")
        drawn = len(session.drawn)
        talk.send(type="patch", patch={}, id=1)
        talk.until("idle")
        assert talk.frames[-1][0].version == 2
        assert isinstance(talk.frames[-1][0], FrameHeader)
        assert len(session.drawn) == drawn
