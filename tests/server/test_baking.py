"""States that need a precomputation, on the socket."""

from __future__ import annotations

from typing import Any

from starlette.testclient import TestClient

from tests.server.fake_session import FakeSession
from tests.server.talk import Talk


def open_at_rest(socket: Any, hello: dict[str, Any]) -> Talk:
    talk = Talk(socket)
    talk.send(**{**hello, "state": {"scene": "fake", "quality": {"kind": "draft"}}})
    talk.until("idle")
    talk.frames.clear()
    return talk


def test_a_bake_reports_progress_and_ends_with_ready(
    client: TestClient, session: FakeSession, hello: dict[str, Any]
) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = open_at_rest(socket, hello)
        session.bake_gate.clear()
        talk.send(type="patch", patch={"density": 5}, id=1)
        progress = talk.until("progress")
        assert (progress["name"], progress["words"], progress["cancellable"]) == ("density", "baking", True)
        assert talk.until("progress")["fraction"] > progress["fraction"]
        session.bake_gate.set()
        talk.until("ready")
        talk.until("idle")
        assert talk.frames[-1][0].version == 2


def test_a_coarse_picture_comes_before_the_fine_one(
    client: TestClient, session: FakeSession, hello: dict[str, Any]
) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = open_at_rest(socket, hello)
        session.bake_gate.clear()
        session.coarse_density = 0.5  # baked at once: the gate holds what is above 1
        talk.send(type="patch", patch={"density": 5}, id=1)
        talk.until("idle")
        drawn = [header.version for header, _ in talk.frames]
        assert drawn == [2]
        assert 5 not in session.baked
        session.bake_gate.set()
        talk.until("ready")
        talk.until("idle")
        assert [header.version for header, _ in talk.frames] == [2, 2]
        assert 5 in session.baked


def test_a_newer_state_drops_the_older_bake(client: TestClient, session: FakeSession, hello: dict[str, Any]) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = open_at_rest(socket, hello)
        session.bake_gate.clear()
        talk.send(type="patch", patch={"density": 5}, id=1)
        talk.until("progress")
        talk.send(type="patch", patch={"density": 6}, id=2)
        talk.until("state")
        for _ in range(5):
            talk.until("progress")
        wanted = [preparation.cancelled for preparation in session.preparations]
        assert wanted[-1] is False
        assert wanted[-2] is True
        session.bake_gate.set()
        talk.until("idle")
        assert [header.version for header, _ in talk.frames] == [3]
        assert not any(message["type"] == "error" for message in talk.messages)


def test_cancelling_goes_back_to_the_last_drawn_state(
    client: TestClient, session: FakeSession, hello: dict[str, Any]
) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = open_at_rest(socket, hello)
        session.bake_gate.clear()
        talk.send(type="patch", patch={"density": 5}, id=1)
        assert talk.until("state")["state"]["density"] == 5
        talk.until("progress")
        talk.send(type="cancel")
        assert "cancelled" in talk.until("error")["message"]
        back = talk.until("state")
        assert (back["version"], back["state"]["density"]) == (3, 1)
        talk.until("ready")
        talk.until("idle")
        assert session.preparations[-1].cancelled


def test_a_bake_that_fails_names_its_field_and_goes_back(
    client: TestClient, session: FakeSession, hello: dict[str, Any]
) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = open_at_rest(socket, hello)
        talk.send(type="patch", patch={"density": 999}, id=1)
        refused = talk.until("error")
        assert (refused["field"], refused["allowed"]) == ("density", "1 to 998")
        assert talk.until("state")["state"]["density"] == 1


def test_a_client_that_leaves_lets_its_bake_go(client: TestClient, session: FakeSession, hello: dict[str, Any]) -> None:
    session.bake_gate.clear()
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        talk.send(**{**hello, "state": {"scene": "fake", "density": 9}})
        talk.until("progress")
    assert session.preparations[-1].cancelled


def test_a_bake_beside_does_not_stop_the_pictures(
    client: TestClient, session: FakeSession, hello: dict[str, Any]
) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = open_at_rest(socket, hello)
        session.bake_gate.clear()
        talk.send(type="compare", patch={"density": 5})
        talk.until("progress")
        talk.send(type="patch", patch={"brightness": 0.9}, id=1)
        while talk.frame().version != 2:
            pass
        assert {header.stream for header, _ in talk.frames} == {0}
        session.bake_gate.set()
        talk.until("idle")
        while 1 not in {header.stream for header, _ in talk.frames}:
            talk.frame()


def test_a_first_state_that_cannot_be_baked_gives_way_to_the_scene_s_own(
    client: TestClient, hello: dict[str, Any]
) -> None:
    """Born from a link to a file that had expired: it showed an error, and never a picture."""
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        talk.send(**{**hello, "state": {"scene": "fake", "density": 999}})
        assert talk.until("error")["field"] == "density"
        assert talk.until("state")["state"]["density"] == 1
        talk.until("idle")
        assert talk.frames[-1][0].version == 2


def test_an_opening_that_cannot_be_baked_is_told_once(
    client: TestClient, session: FakeSession, hello: dict[str, Any]
) -> None:
    with client.websocket_connect("/api/session") as socket:
        session.bake_gate.clear()
        session.baked.clear()
        talk = Talk(socket)
        talk.send(**hello)
        talk.until("progress")
        talk.send(type="cancel")
        assert "cancelled" in talk.until("error")["message"]
        talk.until("ready")
        assert talk.silent(0.3)
