"""Random requests made from the server's own OpenAPI description."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
import schemathesis
from hypothesis import HealthCheck, Phase, settings
from schemathesis.checks import not_a_server_error

from server.app import create_app
from server.settings import Settings
from tests.server.fake_session import FakeSession
from tests.server.test_wire import running

schema = schemathesis.openapi.from_dict(create_app(FakeSession(Path()), Settings()).openapi())


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A server for all cases: whatever one of them breaks, the next ones notice."""
    session = FakeSession(tmp_path_factory.mktemp("fuzz"))
    with running(session, jobs=3, max_side=64, max_pixels=4096) as (port, _):
        yield f"http://127.0.0.1:{port}"
    session.close()


@schema.parametrize()
@settings(
    max_examples=10,
    deadline=None,
    derandomize=True,
    phases=[Phase.explicit, Phase.generate],
    suppress_health_check=list(HealthCheck),
)
def test_a_random_request_is_answered_or_refused_in_words(case: schemathesis.Case, address: str) -> None:
    response = case.call(base_url=address)
    case.validate_response(response, checks=[not_a_server_error] if response.status_code != 503 else [])
    if response.status_code >= 400 and case.method != "HEAD":
        for error in response.json()["errors"]:
            assert set(error) == {"field", "message", "allowed"}
            assert error["message"]
            assert "Traceback" not in error["message"]
