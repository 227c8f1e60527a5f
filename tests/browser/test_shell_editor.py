"""The shell editor: lines that lie where the camera has them, paint by pointer, finger and key, refusals in words."""

from __future__ import annotations

import base64
import io
import json
import urllib.request
from typing import Any

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Page

from renderer.core.params import validate
from renderer.shells.state import ShellsState
from renderer.world.camera import Look, Orbit, Orthographic, rays
from renderer.world.projection import view_projection
from tests.browser import house
from tests.browser.conftest import Open
from tests.browser.test_accessibility import violations

QUICK = {
    "quality": {"kind": "samples", "n": 1},
    "shadow.kind": "none",
    "texture": {"kind": "uniform"},
    "surface": {"kind": "tube"},
    "camera": {"kind": "orbit", "target": [0.1, 0, 0], "distance": 4, "azimuth": 150, "elevation": 20},
}
CAMERAS = (
    Orbit(target=(1.0, 2.0, 3.0), distance=5.0, azimuth=200.0, elevation=35.0, field_of_view=50.0),
    Look(eye=(3.0, -4.0, 2.0), target=(0.5, 0.0, 0.1), up=(0.1, 0.2, 1.0), field_of_view=30.0),
    Orthographic(centre=(0.5, 0.0, 0.2), direction=(0.3, 1.0, -0.4), up=(0.0, 0.0, 1.0), width=3.0),
)
TWIN = """async ([camera, at]) => {
  const { ray, matrix } = await import('/projection.js');
  const { origin, way } = ray(camera, 1.6, 0.2, 0.7);
  return { origin, way, matrix: [...matrix(camera, 1.6, at, 4)] };
}"""
DRAWN = "(view) => { umbrage.editor.choose(view); return umbrage.editor.lines.canvas.toDataURL('image/png'); }"


@pytest.fixture(scope="module")
def tube(service: house.Service) -> dict[str, Any]:
    """A tube that is soon baked and drawn."""
    return service.session.state("shells", sets=QUICK).model_dump(mode="json")


def edit(page: Page) -> None:
    """Open the editor and wait for its lines."""
    page.get_by_role("button", name="Edit the shell").click()
    house.until(page, "umbrage.editor?.outline != null")


def alpha(page: Page, view: str) -> np.ndarray:
    """Opacity of the lines over the picture, (H, W) uint8; drawn and read in one turn, or the canvas is blank."""
    text = page.evaluate(DRAWN, view)
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(text.split(",")[1]))).convert("RGBA"))[..., 3]


def outline(page: Page) -> dict[str, np.ndarray]:
    """The lines' arrays by HTTP."""
    address = page.evaluate("new URL('api/outline', document.baseURI).href")
    body = json.dumps({"state": house.state_of(page)}).encode()
    with urllib.request.urlopen(urllib.request.Request(address, body, {"Content-Type": "application/json"})) as answer:
        arrays = json.loads(answer.read())["arrays"]
    return {
        name: np.frombuffer(base64.b64decode(coded["base64"]), coded["dtype"]).reshape(coded["shape"])
        for name, coded in arrays.items()
    }


def test_lines_lie_on_the_shell_and_paint_goes_where_the_pointer_is(open_page: Open, tube: dict[str, Any]) -> None:
    page = open_page(tube, bypass_csp=True)
    for camera in CAMERAS:
        twin = page.evaluate(TWIN, [camera.model_dump(mode="json"), [0.2, 0.1, 0.3]])
        origins, ways = rays(camera, 160, 100, (0.0, 0.0))
        np.testing.assert_allclose(twin["origin"], origins[70, 32], atol=1e-9)
        np.testing.assert_allclose(twin["way"], ways[70, 32], atol=1e-9)
        met = np.append(np.subtract(origins[70, 32] + 3 * ways[70, 32], [0.2, 0.1, 0.3]), 1.0)
        x, y, _, w = np.reshape(twin["matrix"], (4, 4)).T @ met
        np.testing.assert_allclose([x / w, y / w], [-0.6, -0.4], atol=1e-5)
    edit(page)
    seen = alpha(page, "cells") > 20
    positions, state = outline(page)["positions"], validate(ShellsState, house.state_of(page))
    height, width = seen.shape
    clip = view_projection(state.camera, (width, height), (0.5, 0.5), np.zeros(3), (1.0, 10.0))
    at = np.column_stack([positions, np.ones(len(positions))]) @ clip.T
    places = (at[:, :2] / at[:, 3:] * [1, -1] + 1) / 2 * [width, height]
    rows, columns = np.nonzero(seen)
    ends = [columns.min(), rows.min(), columns.max() + 1, rows.max() + 1]
    np.testing.assert_allclose(ends, [*places.min(axis=0), *places.max(axis=0)], atol=1.5)
    assert alpha(page, "none").max() == 0
    assert 0 < (alpha(page, "shell") > 20).sum() < seen.sum()

    page.get_by_role("switch", name="Paint the thickness").check()
    page.mouse.move(640, 380)
    page.mouse.down()
    page.mouse.move(640, 460, steps=6)
    page.mouse.up()
    assert violations(page) == []
    paint = house.state_of(page)["extrusion"]["paint"]
    assert len(paint) >= 2
    assert house.state_of(page)["camera"] == tube["camera"], "the camera stays"
    for dab in paint:
        assert np.hypot(*dab["at"][:2]) == pytest.approx(0.5, abs=0.2)
    house.settled(page)
    house.until(page, "!umbrage.editor.asking")
    thick = np.linalg.norm(np.subtract(*np.split(outline(page)["positions"], 2)), axis=1)
    assert thick.min() < 0.75 * thick.max()
    page.get_by_role("button", name="Undo", exact=True).click()
    assert house.state_of(page)["extrusion"]["paint"] == []
    page.keyboard.press("Escape")
    page.mouse.move(640, 380)
    page.mouse.down()
    page.mouse.move(700, 380, steps=3)
    page.mouse.up()
    assert house.state_of(page)["extrusion"]["paint"] == []
    assert house.state_of(page)["camera"]["azimuth"] != 150


def test_a_finger_paints_two_move_the_camera_enter_paints_and_nonsense_is_refused(
    open_page: Open, tube: dict[str, Any]
) -> None:
    page = open_page(tube, viewport={"width": 390, "height": 844}, has_touch=True)
    edit(page)
    entry = page.locator("#editor [data-path='extrusion.thickness'] input.entry")
    entry.fill("5000")
    entry.press("Enter")
    house.until(page, "document.querySelector('#editor .field-error').textContent.includes('1000')")
    house.settled(page)
    assert house.state_of(page)["extrusion"]["thickness"] == tube["extrusion"]["thickness"]
    page.get_by_role("switch", name="Paint the thickness").check()
    assert page.locator("#editor [data-path='extrusion.thickness']").is_hidden(), "the brush alone leaves the room"
    hand = page.context.new_cdp_session(page)

    def touch(kind: str, *places: tuple[int, int]) -> None:
        points = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(places)]
        hand.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    touch("touchStart", (195, 420))
    touch("touchMove", (195, 440))
    touch("touchEnd")
    assert len(house.state_of(page)["extrusion"]["paint"]) == 1
    touch("touchStart", (195, 420))
    touch("touchStart", (195, 420), (215, 460))
    touch("touchMove", (165, 380), (245, 500))
    touch("touchEnd")
    assert len(house.state_of(page)["extrusion"]["paint"]) == 1
    assert house.state_of(page)["camera"]["distance"] < 3.5
    page.focus("#surface")
    page.keyboard.press("Enter")
    assert len(house.state_of(page)["extrusion"]["paint"]) == 2
    assert page.text_content("#editor [role=status]") == "2 of 256 dabs of paint."
    page.get_by_role("button", name="Take all paint off").click()
    assert house.state_of(page)["extrusion"]["paint"] == []
    house.settled(page)
