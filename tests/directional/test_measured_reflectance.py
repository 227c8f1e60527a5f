"""The quantity `reflectance`, at every door: closed forms, tables, files, reciprocity, albedo, refusals."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.special import beta
from starlette.testclient import TestClient

from renderer.core.errors import AssetError, InputError, InvalidDocument, LimitError
from renderer.directional.measured_reflectance import VIEWS, lights, read_directions
from renderer.session import Session
from renderer.study import measure as door
from server import cli
from server.app import create_app
from server.settings import Settings
from tests.server.fake_session import FakeSession

PAIRS = [[30.0, 10.0, 40.0, 200.0], [0.0, 0.0, 0.0, 0.0], [60.0, 90.0, 60.0, 270.0]]


def found(surface: Any, directions: Any = PAIRS, files: Any = None, **more: Any) -> Mapping[str, np.ndarray]:
    return door.measure("reflectance", {"material": surface, "directions": directions, **more}, files).arrays


def test_a_lobe_in_closed_form() -> None:
    seen = found({"kind": "phong", "diffuse": [0.3, 0.2, 0.1], "specular": 0.4, "shininess": 5.0})
    cosine = math.sin(math.radians(30)) * math.sin(math.radians(40)) * math.cos(math.radians(10)) + math.cos(
        math.radians(30)
    ) * math.cos(math.radians(40))
    lobe = 0.4 * 7 / (2 * math.pi) * np.array([cosine**5, 1.0, 1.0])
    assert seen["brdf"] == pytest.approx(np.array([0.3, 0.2, 0.1]) / math.pi + lobe[:, None])
    assert seen["albedo"][1] == pytest.approx([0.7, 0.6, 0.5], abs=1e-6)
    assert np.abs(seen["reciprocity_error"]).max() < 1e-15


def test_lafortune_in_closed_form() -> None:
    """At the normal rho Cz^n 2 pi / (n + 2) (formulas f); a matt one by the name alone."""
    lobe = {"kind": "lafortune", "diffuse": [0, 0, 0], "colour": [0.5, 1, 2], "cxy": -0.9, "cz": 0.8, "exponent": 6}
    seen = found(lobe, [[0, 0, 0, 0]])
    assert seen["brdf"][0] == pytest.approx(np.array([0.5, 1, 2]) * 0.8**6)
    assert seen["albedo"][0] == pytest.approx(np.array([0.5, 1, 2]) * 0.8**6 * 2 * math.pi / 8)
    level = found({"kind": "phong", "diffuse": [0, 0, 0], "specular": 1, "shininess": 3}, [[90, 0, 10, 0]])
    assert level["albedo"][0, 0] == pytest.approx(5 / (2 * math.pi) * beta(2, 1.5), rel=1e-3)
    assert found("matte", albedo=False).keys() == {"directions_deg", "brdf", "reciprocity_error"}


def test_the_lights_of_an_albedo_fill_the_hemisphere() -> None:
    ways, weights = lights(16)
    assert weights.sum() == pytest.approx(math.pi)
    assert weights @ ways[:, 2] ** 2 == pytest.approx(math.pi / 2)  # of cosine cubed: 2 pi / 4


@pytest.mark.parametrize(("kind", "off"), [("matte", 0.004), ("satin", 0.06), ("metal", 0.02)])
def test_tables_against_the_models_that_they_sample(kind: str, off: float) -> None:
    """What a table leaves out between its nodes, rms over pairs in the picture's usual range, of the rms value."""
    rng = np.random.default_rng(3)
    pairs = np.stack([rng.uniform(0, 75, 400), rng.uniform(0, 360, 400)] * 1, axis=1)
    pairs = np.concatenate([pairs, np.stack([rng.uniform(0, 75, 400), rng.uniform(0, 360, 400)], axis=1)], axis=1)
    table, model = (found(kind, pairs.tolist(), read=how, albedo=False)["brdf"] for how in ("table", "model"))
    assert np.sqrt(((table - model) ** 2).mean() / (model**2).mean()) < off


@pytest.mark.parametrize("kind", ["matte", "satin", "metal"])
def test_reciprocity_of_tables_is_that_of_their_models(kind: str) -> None:
    """Same nodes for view and light: exact up to rounding where both have the same; and no more albedo than 1."""
    rng = np.random.default_rng(5)
    pairs = rng.uniform(0, 1, (300, 4)) * [80, 360, 80, 360]
    seen = found(kind, pairs.tolist(), albedo=False)
    assert np.abs(seen["reciprocity_error"]).max() < 1e-6 * max(1, seen["brdf"].max())
    views = [[theta, 40.0, 0.0, 0.0] for theta in (0.0, 35.0, 70.0, 85.0)]
    assert found(kind, views)["albedo"].max() < 1.02


def test_the_validation_table_sends_its_reflectance_and_is_not_reciprocal() -> None:
    seen = found({"kind": "validation", "reflectance": 0.6})
    assert seen["albedo"] == pytest.approx(0.6, rel=2e-3)
    assert np.abs(seen["reciprocity_error"]).max() > 0.01
    assert seen["brdf"] == pytest.approx(found({"kind": "validation", "reflectance": 0.6}, read="model")["brdf"])


def test_a_file_of_ones_own_through_the_command_line(tmp_path: Path) -> None:
    theta, phi = np.array([0.0, 45, 90]), np.array([0.0, 120, 240])
    values = np.random.default_rng(2).random((3, 3, 3, 3))
    values[0], values[:, 0] = 0.25, 0.25
    np.savez(tmp_path / "own.npz", brdf=values, theta_o=theta, theta_l=theta, delta_phi=phi)
    (tmp_path / "pairs.csv").write_text("theta_o,phi_o,theta_l,phi_l\n45,30,90,150\n45,0,67.5,60\n")
    out = tmp_path / "out.json"
    given = ["--brdf", str(tmp_path / "own.npz"), "--directions", str(tmp_path / "pairs.csv")]
    assert cli.main(["measure", "reflectance", *given, "--albedo", "false", "-o", str(out)]) == 0
    answer = json.loads(out.read_text())
    assert answer["brdf"][0] == pytest.approx(values[1, 2, 1])  # on a node: 120 degrees apart
    mean = (values[1, 1, 0] + values[1, 1, 1] + values[1, 2, 0] + values[1, 2, 1]) / 4
    assert answer["brdf"][1] == pytest.approx(mean)
    assert "difference" in answer["meta"]["notes"][0]


@pytest.fixture
def web(tmp_path: Path) -> Iterator[TestClient]:
    class Measuring(FakeSession):
        quantities = staticmethod(Session.quantities)
        measure = staticmethod(Session.measure)

    session = Measuring(tmp_path)
    with TestClient(create_app(session, Settings(study=str(tmp_path))), base_url="http://127.0.0.1:8000") as client:
        yield client
    session.close()


def test_rest_answers_alike_and_names_what_is_wrong(web: TestClient) -> None:
    answer = web.post("/api/measure/reflectance", json={"material": {"kind": "satin"}, "directions": PAIRS})
    assert answer.status_code == 200, answer.text
    assert np.array(answer.json()["brdf"]) == pytest.approx(found("satin")["brdf"])
    refused = web.post("/api/measure/reflectance", json={"material": "satin", "directions": [[95, 0, 0, 0]]})
    assert (refused.status_code, refused.json()["errors"][0]["field"]) == (422, "directions.0.0")


def test_bad_questions_are_refused_in_words(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="none is given"):
        found("matte", [])
    with pytest.raises(InvalidDocument, match="material"):
        found("velvet")
    with pytest.raises(LimitError, match="views"):
        found("matte", [[0.1 * k, 0, 0, 0] for k in range(VIEWS + 1)])
    bad = tmp_path / "bad.npz"
    np.savez(bad, brdf=np.zeros((2, 2)))
    with pytest.raises(AssetError) as refused:
        found("matte", files={"brdf": bad})
    assert refused.value.field == "brdf"
    for text in ("a,b\n1,2\n", "1,2,3,4\n1,2,3\n", "100,0,0,0\n"):
        (tmp_path / "pairs.csv").write_text(text)
        with pytest.raises(AssetError, match="directions"):
            read_directions(tmp_path / "pairs.csv")
