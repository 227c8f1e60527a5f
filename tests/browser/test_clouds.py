"""The scene of clouds on the page: another scene and back, time that runs, the way to space, a file of one's own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page

from tests.browser import house
from tests.browser.conftest import Open

QUICK = {
    "phase.kind": "henyey_greenstein",
    "scattering.kind": "single",
    "bounce.kind": "none",
    "quality": {"kind": "samples", "n": 1},
    "clouds.systems": False,
}


@pytest.fixture(scope="module")
def layer(service: house.Service) -> dict[str, Any]:
    """A state of the clouds that is soon baked and drawn."""
    return service.session.state("clouds", "valley", QUICK).model_dump(mode="json")


def test_another_scene_brings_its_presets_and_its_controls_and_the_first_comes_back(
    open_page: Open, layer: dict[str, Any]
) -> None:
    page = open_page(layer)
    study = page.get_by_role("button", name="Study the sun over days")
    assert study.is_hidden(), "the sun is studied over the forest's land"
    page.click("#scene")
    page.check("#gallery input[value=forest]", force=True)
    house.until(page, "umbrage.store.scene.name === 'forest'")
    assert page.text_content("#scene .scene-name") == "Forest"
    assert page.locator("#gallery .thumbnail-title").first.text_content() == "Noon"
    assert page.locator("#controls [data-path='shadow']").count() == 1
    assert page.locator("#controls [data-path='phase']").count() == 0
    assert study.is_visible()
    page.check("#gallery input[value=clouds]", force=True)
    house.until(page, "umbrage.store.scene.name === 'clouds'")
    assert page.locator("#gallery .thumbnail-title").first.text_content() == "Sea of clouds"
    assert house.state_of(page)["layer"]["base"] == 2500


def test_time_runs_and_holds_by_the_keyboard_where_something_moves(open_page: Open, layer: dict[str, Any]) -> None:
    page = open_page(layer)
    page.wait_for_selector("#timeline [aria-label='Let time run']")
    page.focus("#timeline [aria-label='Let time run']")
    page.keyboard.press("Enter")
    house.until(page, "umbrage.store.document.time > 5")
    page.keyboard.press("Space")
    assert page.get_attribute("#timeline button:focus", "aria-pressed") == "false"
    held = house.state_of(page)["time"]
    house.settled(page)
    assert house.state_of(page)["time"] == held
    page.click("[aria-label='Undo']")
    assert house.state_of(page)["time"] == 0, "a run is one step of undo"


def test_nothing_runs_in_a_scene_that_stands_still(page: Page) -> None:
    house.until(page, "document.querySelector('#timeline').innerHTML.includes('time run')")
    assert page.locator("[aria-label='Let time run']").is_hidden()


def test_the_wheel_goes_from_the_valley_to_space(open_page: Open, layer: dict[str, Any]) -> None:
    """An orbit's distance grows; a flying camera retreats upwards, though it looks up."""
    page = open_page(layer)
    page.mouse.move(400, 300)
    for _ in range(80):
        page.mouse.wheel(0, 100)
    assert house.state_of(page)["camera"]["distance"] > 2e7
    look = {"kind": "look", "eye": [5525, 3325, 240], "target": [5500, -2000, 600], "up": [0, 0, 1], "field_of_view": 5}
    page.evaluate("(camera) => umbrage.store.change({ camera })", look)
    for _ in range(90):
        page.mouse.wheel(0, 100)
    x, y, z = house.state_of(page)["camera"]["eye"]
    assert np.linalg.norm((x, y, z)) > 2e7
    assert z > 1e6
    house.settled(page)


def test_a_picture_of_clouds_is_taken_for_their_map(open_page: Open, layer: dict[str, Any], tmp_path: Path) -> None:
    page = open_page(layer)
    np.savez(tmp_path / "thick.npz", thickness=np.eye(64, dtype=np.float32))
    page.set_input_files("input[type=file]", str(tmp_path / "thick.npz"))
    page.click("#dialog >> text=Use for: cloud map")
    house.settled(page)
    assert house.state_of(page)["clouds"]["kind"] == "asset"
