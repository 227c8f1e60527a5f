from __future__ import annotations

import base64
import io
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from starlette.testclient import TestClient

from server.routes.render import negotiate
from server.settings import Settings
from tests.server.fake_session import FakeSession, FakeState, paint

SMALL = {"scene": "fake", "width": 24, "height": 16, "quality": {"kind": "samples", "n": 3}}


def errors(answer: Any) -> list[dict[str, str]]:
    found: list[dict[str, str]] = answer.json()["errors"]
    return found


def test_health_tells_what_it_draws_with(client: TestClient) -> None:
    health = client.get("/api/health").json()
    assert health["status"] == "ok"
    assert health["gl"] == {"renderer": "fake", "version": [3, 3], "software": True}


def test_scenes_are_described_and_unknown_ones_are_not_found(client: TestClient) -> None:
    assert client.get("/api/scenes").json()[0]["name"] == "fake"
    assert client.get("/api/scenes/fake").json()["defaults"]["brightness"] == 0.5
    assert client.get("/api/scenes/fake/presets/noon").json()["brightness"] == 0.75
    missing = client.get("/api/scenes/atlantis")
    assert missing.status_code == 404
    assert errors(missing) == [{"field": "scene", "message": "there is no such scene", "allowed": "fake"}]


def test_a_thumbnail_is_drawn_once_and_then_not_even_sent(client: TestClient, session: FakeSession) -> None:
    address = "/api/scenes/fake/presets/noon/thumbnail.jpg"
    first = client.get(address)
    assert Image.open(io.BytesIO(first.content)).size == (320, 200)
    again = client.get(address, headers={"If-None-Match": first.headers["etag"]})
    assert again.status_code == 304
    assert client.get(address).content == first.content
    assert session.renders == 1
    assert client.get("/api/scenes/fake/presets/night/thumbnail.jpg").status_code == 404


@pytest.mark.parametrize(
    ("accept", "media"),
    [("image/png", "image/png"), ("image/jpeg", "image/jpeg"), ("application/x-npy", "application/x-npy"),
     ("image/x-exr", "image/x-exr"), ("*/*", "image/png"), ("image/png;q=0.1, image/*", "image/jpeg")],
)  # fmt: skip
def test_the_format_follows_the_accept_header(client: TestClient, accept: str, media: str) -> None:
    answer = client.post("/api/render", json=SMALL, headers={"Accept": accept})
    assert (answer.status_code, answer.headers["content-type"]) == (200, media)
    assert answer.headers["x-umbrage-samples"] == "3"
    if media == "image/png":
        assert np.array_equal(np.asarray(Image.open(io.BytesIO(answer.content))), paint(FakeState(), 24, 16))
    if media == "application/x-npy":
        linear = np.load(io.BytesIO(answer.content))
        assert (linear.dtype, linear.shape) == (np.float32, (16, 24, 4))


def test_what_a_state_would_cost_is_told_before_it_is_paid(client: TestClient, session: FakeSession) -> None:
    baked, new = ({"scene": "fake", "sets": {"density": density}} for density in (1, 5))
    assert client.post("/api/cost", json=baked).json() == {"seconds": 0}
    assert client.post("/api/cost", json=new).json() == {"seconds": 1}
    assert session.preparations == []
    assert client.post("/api/cost", json={"scene": "fake", "sets": {"density": 0}}).status_code == 422


def test_no_acceptable_format_is_said(client: TestClient) -> None:
    answer = client.post("/api/render", json=SMALL, headers={"Accept": "text/html"})
    assert answer.status_code == 406
    assert "image/png" in errors(answer)[0]["allowed"]


def test_negotiation_follows_weights_and_specific_ranges() -> None:
    assert negotiate("") == "image/png"
    assert negotiate("image/*;q=0.5, application/x-npy;q=0.9") == "application/x-npy"
    assert negotiate("*/*, image/png;q=0") == "image/jpeg"
    assert negotiate("image/png;q=walrus") is None


@pytest.mark.parametrize(
    ("change", "status", "field"),
    [
        ({"width": 7000, "height": 7000}, 422, "width"), ({"width": 0}, 422, "width"),
        ({"height": "tall"}, 422, "height"),
        ({"walrus": 1}, 422, "walrus"), ({"scene": None}, 422, "scene"), ({"scene": "atlantis"}, 422, "scene"),
        ({"preset": "night"}, 422, "preset"), ({"sets": {"brightness": 3}}, 422, "brightness"),
        ({"sets": {"": 3}}, 422, ""), ({"sets": {"sun.kind": 3}}, 422, "sun.kind"),
        ({"state": {"scene": "fake", "density": 0}}, 422, "density"), ({"state": 3}, 422, "state"),
        ({"quality": {"kind": "best"}}, 422, "quality.kind"),
        ({"quality": {"kind": "samples", "n": 10**9}}, 422, "quality.n"),
    ],
)  # fmt: skip
def test_a_wrong_request_names_its_field(client: TestClient, change: dict[str, Any], status: int, field: str) -> None:
    answer = client.post("/api/render", json={**SMALL, **change})
    assert answer.status_code == status
    assert errors(answer)[0]["field"] == field


def test_what_a_request_allows_is_said_in_the_house_s_words(client: TestClient) -> None:
    """FastAPI's own sentences speak of inputs and give no range."""
    small = errors(client.post("/api/render", json={**SMALL, "width": 0}))
    assert small == [{"field": "width", "message": "is too small", "allowed": "at least 1"}]
    kind = errors(client.post("/api/jobs", json={"kind": "walk", "scene": "fake"}))
    assert kind == [{"field": "kind", "message": "is none of the choices", "allowed": "bake, reference, sunlight"}]
    broken = client.post("/api/render", content=b"{", headers={"Content-Type": "application/json"})
    assert errors(broken) == [{"field": "", "message": "is not valid JSON", "allowed": ""}]


@pytest.mark.parametrize(
    "body",
    [b'{"scene":"fake","width":NaN}', b'{"scene":"fake","state":{"brightness":NaN}}', b"{", b"", b"[" * 50_000,
     b"\xff\xfe",
     b'{"scene":"fake","\\ud800":1}', b'{"scene":"fake","sets":{"\\ud800":1}}', b'{"width":' + b"9" * 5000 + b"}"],
)  # fmt: skip
def test_a_broken_body_is_refused_in_words_and_not_echoed(client: TestClient, body: bytes) -> None:
    answer = client.post("/api/render", content=body, headers={"Content-Type": "application/json"})
    assert answer.status_code in (400, 422)
    assert errors(answer)[0]["message"]
    assert "NaN" not in answer.text


def test_a_body_beyond_its_limit_is_refused_whatever_it_claims(client: TestClient) -> None:
    big = b'{"scene":"' + b"a" * 70_000 + b'"}'
    assert client.post("/api/render", content=big).status_code == 413
    assert client.post("/api/render", content=iter([big[:50_000], big[50_000:]])).status_code == 413
    claimed = client.post("/api/render", content=b"{}", headers={"Content-Length": str(2 << 30)})
    assert claimed.status_code == 413
    assert "65536" in errors(claimed)[0]["allowed"]


def test_too_many_pictures_at_once_are_refused_with_a_time_to_retry(tmp_path: Path, session: FakeSession) -> None:
    from server.app import create_app

    session.draw_seconds = 0.4
    app = create_app(session, Settings(hosts="testserver", requests=1))
    with TestClient(app, raise_server_exceptions=False) as client:
        first = threading.Thread(
            target=client.post, args=("/api/render",), kwargs={"json": {**SMALL, "width": 64, "height": 64}}
        )
        first.start()
        time.sleep(0.2)
        busy = client.post("/api/render", json=SMALL)
        first.join()
        assert (busy.status_code, busy.headers["retry-after"]) == (503, "5")
        assert "1 at once" in errors(busy)[0]["allowed"]
        assert client.post("/api/render", json=SMALL).status_code == 200


def test_an_upload_is_checked_stored_and_listed(client: TestClient) -> None:
    stored = client.post("/api/assets", files={"file": ("../../etc/hill.npz", b"good bytes")})
    assert (stored.status_code, stored.json()["name"]) == (201, "hill.npz")
    assert client.get("/api/assets").json()[0]["hash"] == "abc"
    assert client.get("/api/assets/asset:abc").json()["kind"] == "terrain"
    assert client.get("/api/assets/other").status_code == 404


def test_what_a_file_leaves_unsaid_comes_beside_it(client: TestClient) -> None:
    beside = {"holes": "fill", "cell_size": "[12, 7.5]"}
    stored = client.post("/api/assets", files={"file": ("hill.npz", b"good bytes")}, data=beside)
    assert (stored.status_code, stored.json()["reading"]) == (201, {"holes": "fill", "cell_size": [12, 7.5]})
    much = client.post("/api/assets", files={"file": ("hill.npz", b"good bytes")}, data={"notes": "x" * 5000})
    assert (much.status_code, errors(much)[0]["field"]) == (422, "file")


def test_uploads_are_counted_while_they_come(session: FakeSession) -> None:
    from server.app import create_app

    def slowly() -> Iterator[bytes]:
        yield b'--b\r\nContent-Disposition: form-data; name="file"; filename="a.npz"\r\n\r\ngood'
        yield b"\r\n--b--\r\n"

    app = create_app(session, Settings(hosts="testserver", requests=1))
    form = {"Content-Type": "multipart/form-data; boundary=b"}
    with TestClient(app, raise_server_exceptions=False) as client:
        with app.state.hub.admitted():
            assert client.post("/api/assets", content=slowly(), headers=form).status_code == 503
        assert client.post("/api/assets", content=slowly(), headers=form).status_code == 201


@pytest.mark.parametrize("data", [b"", b"bad", b"good" + b"x" * 5000, b"good" + b"x" * 100_000])
def test_a_bad_upload_is_refused_in_words(client: TestClient, data: bytes) -> None:
    answer = client.post("/api/assets", files={"file": ("a.npz", data)})
    assert answer.status_code in (413, 422)
    assert errors(answer)[0]["message"]
    assert client.get("/api/assets").json() == []


def test_an_upload_cut_short_is_refused(client: TestClient) -> None:
    cut = b'--b\r\nContent-Disposition: form-data; name="file"; filename="a.npz"\r\n\r\ngood'
    answer = client.post("/api/assets", content=cut, headers={"Content-Type": "multipart/form-data; boundary=b"})
    assert answer.status_code in (400, 422)
    assert client.post("/api/assets", content=b"x", headers={"Content-Type": "multipart/form-data"}).status_code in (
        400,
        422,
    )


def test_a_quantity_is_measured_from_the_address_from_a_body_and_from_a_file(client: TestClient) -> None:
    assert client.get("/api/measure").json()[0]["name"] == "length"
    assert client.get("/api/measure/length?factor=1.5").json()["length"] == [3.0, None]
    client.post("/api/assets", files={"file": ("a.npz", b"good bytes")})
    measured = client.post("/api/measure/length", json={"factor": 2, "terrain": "asset:abc"}).json()
    assert (measured["length"][0], measured["meta"]["units"]) == (20.0, {"length": "m"})
    npz = client.post("/api/measure/length", json={}, headers={"Accept": "application/x-npz"})
    assert np.load(io.BytesIO(npz.content))["length"][0] == 2.0


@pytest.mark.parametrize(
    ("quantity", "body", "status", "field"),
    [("weight", {}, 404, "quantity"), ("length", {"mass": 1}, 422, "mass"),
     ("length", {"factor": "NaN"}, 422, "factor"),
     ("length", {"terrain": "/etc/passwd"}, 422, "terrain"), ("length", {"terrain": "asset:../x"}, 422, "asset")],
)  # fmt: skip
def test_a_wrong_measurement_names_its_field(
    client: TestClient, quantity: str, body: dict[str, Any], status: int, field: str
) -> None:
    answer = client.post(f"/api/measure/{quantity}", json=body)
    assert (answer.status_code, errors(answer)[0]["field"]) == (status, field)


def test_lines_come_as_bytes_with_their_shape_and_a_scene_without_any_is_refused_in_words(client: TestClient) -> None:
    answer = client.post("/api/outline", json={"scene": "fake"}).json()
    coded = answer["arrays"]["ends"]
    ends = np.frombuffer(base64.b64decode(coded["base64"]), f"<{np.dtype(coded['dtype']).str[1:]}")
    assert ends.reshape(coded["shape"]).tolist() == [[0, 1], [1, 258]]
    assert answer["facts"] == {"lines": 2}
    assert answer["words"] == ["all is well"]
    refused = client.post("/api/outline", json={"scene": "fake", "sets": {"density": 7}})
    assert refused.status_code == 422
    assert errors(refused)[0]["field"] == "scene"


def test_the_schema_holds_messages_and_states(client: TestClient) -> None:
    schema = client.get("/api/schema").json()
    assert "brightness" in schema["states"]["fake"]["properties"]
    assert set(schema["client"]["discriminator"]["mapping"]) >= {"hello", "patch", "ack", "cancel"}
    assert set(schema["server"]["discriminator"]["mapping"]) >= {"welcome", "error", "idle"}
    assert "sequence" in schema["frame"]["header"]["properties"]


def test_metrics_count(client: TestClient) -> None:
    client.post("/api/render", json=SMALL)
    text = client.get("/metrics").text
    assert "umbrage_pictures_total 1.0" in text
    assert "umbrage_sessions 0.0" in text


def test_the_page_and_the_documentation_load_nothing_from_elsewhere(client: TestClient) -> None:
    page = client.get("/")
    assert page.status_code == 200
    assert page.headers["cache-control"] == "no-cache"
    assert "default-src 'self'" in page.headers["content-security-policy"]
    assert client.get("/", headers={"If-None-Match": page.headers["etag"]}).status_code == 304
    docs = client.get("/docs")
    assert "/api/render" in docs.text
    assert "https://" not in docs.text
    assert client.get("/nothing.js").status_code == 404
    assert client.get("/../pyproject.toml").status_code == 404
