"""Reading the picture: what lies at a point, and how far the picture is from its reference."""

from __future__ import annotations

import io
import json
from typing import Any

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Page, Route

from tests.browser import house
from tests.browser.conftest import Open

SIZE = 8
GREY, WHITE, RED = (90, 90, 90), (255, 255, 255), (255, 0, 0)
COLOURS = {"picture.png": GREY, "reference.png": WHITE, "error.png": RED}
NUMBERS = {
    "relative_rmse": 0.1234, "flip_mean": 0.2, "flip_p95": 0.4, "standard_error": 0.019, "seconds": 12.0,
    "size": [SIZE, SIZE], "legend": [[0.0, [0, 0, 0]], [0.25, [255, 0, 0]], [0.5, [255, 255, 255]]], "saturated": 0.02,
}


def rows(page: Page, panel: str) -> dict[str, str]:
    """The table of a card, by name."""
    names, values = (page.locator(f"{panel} {tag}").all_inner_texts() for tag in ("dt", "dd"))
    return dict(zip(names, values, strict=True))


def test_a_click_tells_what_lies_there_and_follows_the_sun(open_page: Open, document: dict[str, Any]) -> None:
    moment = {"kind": "moment", "date": "2024-06-21", "time": "10:00:00"}
    page = open_page({**document, "sun": moment})
    page.mouse.click(300, 500)
    house.until(page, "!document.querySelector('#probe').hidden")
    facts = rows(page, "#probe")
    assert facts["Above the sea"].endswith(" m")
    assert facts["Slope"].endswith("°")
    assert float(facts["Sun on this day"].removesuffix(" h")) <= 16
    assert page.locator("#probe .horizon-course").count() == 1, "the sun's course over the horizon"
    before = page.locator("#probe .horizon-sun").get_attribute("cx")
    page.evaluate("umbrage.store.change({sun: {time: '16:00:00'}}, 'sun.time')")
    # Polled from outside: the card asks again once the sun stands still.
    house.until(page, f"document.querySelector('#probe .horizon-sun')?.getAttribute('cx') !== '{before}'")
    page.locator("#surface").focus()
    page.keyboard.press("ArrowRight")
    house.until(page, "document.querySelector('#probe').hidden")
    page.keyboard.press("Enter")
    house.until(page, "!document.querySelector('#probe').hidden")
    page.keyboard.press("Escape")
    assert page.locator("#probe").is_hidden()


def answer_reference(page: Page) -> list[dict[str, Any]]:
    """Answer reference jobs in the server's place, which takes a minute; returns what was asked."""
    asked: list[dict[str, Any]] = []

    def reply(route: Route) -> None:
        request = route.request
        if request.method == "POST":
            asked.append(json.loads(request.post_data or ""))
            route.fulfill(status=202, json={"id": "1"})
        elif request.url.endswith(".png"):
            picture = io.BytesIO()
            Image.new("RGB", (SIZE, SIZE), COLOURS[request.url.split("/")[-1]]).save(picture, "PNG")
            route.fulfill(body=picture.getvalue(), content_type="image/png")
        else:
            files = {name: f"/api/jobs/1/files/{name}" for name in COLOURS}
            route.fulfill(json={"id": "1", "status": "done", "result": {"files": files, **NUMBERS}})

    page.route("**/api/jobs**", reply)
    page.route("**/api/jobs/**", reply)
    return asked


def shown(page: Page, x: float) -> np.ndarray:
    """Colour on the screen at a share of the width, where no panel lies."""
    image = np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("RGB"))
    found: np.ndarray = image[image.shape[0] // 2, round(x * image.shape[1])]
    return found


def test_the_reference_is_shown_with_its_numbers_and_the_error_with_its_scale(page: Page) -> None:
    asked = answer_reference(page)
    page.get_by_role("button", name="Compare", exact=True).click()
    page.get_by_role("button", name="Compare with the reference").click()
    house.until(page, "document.querySelector('#stage').hasAttribute('data-truth')")
    assert asked[0]["kind"] == "reference"
    assert max(asked[0]["width"], asked[0]["height"]) == 128
    facts = rows(page, "#compare")
    assert (facts["Relative RMSE"], facts["Compared at"]) == ("12.34 %", "8 × 8")
    assert tuple(shown(page, 0.4)) == GREY, "the picture that was measured, not the live one"
    assert tuple(shown(page, 0.6)) == WHITE
    page.get_by_role("radio", name="Error map").check()
    assert tuple(shown(page, 0.6)) == RED
    assert page.locator("#compare .scale-ends span").all_inner_texts() == ["0 %", "25 %", "50 %"]
    assert "2.00 % of the pixels" in page.locator("#compare").inner_text()
    assert page.locator(".tag-b").inner_text() == "Error"
    page.evaluate("umbrage.store.change({view: {exposure: -7}}, 'view.exposure')")
    house.until(page, "!document.querySelector('#stage').hasAttribute('data-truth')")
    assert tuple(shown(page, 0.4)) != GREY, "a reference of another state is taken off"


@pytest.mark.parametrize("query", ["", "?preset=low_sun"])
def test_the_page_opens_on_a_preset_by_its_name(open_page: Open, service: house.Service, query: str) -> None:
    page = open_page(rest=False).context.new_page()
    page.goto(service.address + query)
    house.until(page, "document.querySelector('.preset-name').textContent !== ''")
    presets = service.session.describe("forest")["presets"]
    wanted = presets["low_sun"] if query else next(iter(presets.values()))
    assert page.locator(".preset-name").inner_text() == wanted["title"]


def test_what_a_precomputation_will_take_is_told_before_it_starts(page: Page) -> None:
    page.locator("[data-slot='shadow'] .slot-button").click()
    page.locator("[data-slot='shadow'] input[value='double_horizon_map']").check()
    house.settled(page)
    page.locator("[data-path='shadow.height_top']").first.hover()
    house.until(page, "/It takes about \\d+ s\\./.test(document.querySelector('#hint').textContent)")
    assert page.locator("#notices .progress").is_hidden(), "nothing has started"
