"""A person at the page: real pointer, touch and keyboard events against the real server."""

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

from tests.browser import house
from tests.browser.conftest import Open


def picture(page: Page) -> np.ndarray:
    """Pixels of the canvas, (H, W, 3) uint8."""
    text = page.evaluate("document.querySelector('#picture').toDataURL('image/png')")
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(text.split(",")[1]))).convert("RGB"))


def changed_share(before: np.ndarray, after: np.ndarray) -> float:
    """Share of the pixels that differ visibly."""
    return float(np.mean(np.abs(before.astype(int) - after.astype(int)).max(axis=2) > 8))


def drag(page: Page, start: tuple[float, float], end: tuple[float, float], steps: int = 8) -> None:
    page.mouse.move(*start)
    page.mouse.down()
    page.mouse.move(*end, steps=steps)
    page.mouse.up()


def test_a_drag_turns_the_camera_and_the_picture_follows(page: Page) -> None:
    before, camera = picture(page), house.state_of(page)["camera"]
    drag(page, (500, 300), (700, 340))
    house.settled(page)
    turned = house.state_of(page)["camera"]
    assert turned["azimuth"] == pytest.approx((camera["azimuth"] + 180 * 200 / 800) % 360)
    assert turned["elevation"] == pytest.approx(camera["elevation"] + 180 * 40 / 800)
    assert changed_share(before, picture(page)) > 0.2
    assert page.evaluate("umbrage.stats.latencies.length") > 0


def test_the_picture_at_rest_is_what_http_renders(page: Page) -> None:
    shown = picture(page)
    body = {"state": house.state_of(page), "width": shown.shape[1], "height": shown.shape[0]}
    address = page.evaluate("new URL('api/render', document.baseURI).href")
    headers = {"Content-Type": "application/json", "Accept": "image/png"}
    request = urllib.request.Request(address, json.dumps(body).encode(), headers)
    with urllib.request.urlopen(request) as answer:
        rendered = np.asarray(Image.open(io.BytesIO(answer.read())).convert("RGB"))
    np.testing.assert_array_equal(shown, rendered)


def test_a_page_at_rest_receives_nothing(page: Page) -> None:
    frames = page.evaluate("umbrage.stats.frames")
    page.wait_for_timeout(600)
    assert page.evaluate("umbrage.stats.frames") == frames


def test_the_dome_moves_the_sun(page: Page) -> None:
    before = picture(page)
    box = page.locator(".dome").bounding_box()
    assert box is not None
    middle = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    drag(page, middle, (middle[0] - 0.36 * box["width"], middle[1]))
    house.settled(page)
    sun = house.state_of(page)["sun"]
    assert sun["azimuth"] == pytest.approx(270, abs=1)
    assert sun["elevation"] == pytest.approx(90 - 90 * 0.36 / 0.4, abs=1)
    assert changed_share(before, picture(page)) > 0.1


def test_the_time_of_day_and_the_dome_agree(page: Page) -> None:
    page.locator("input.day").focus()
    page.keyboard.press("ArrowRight")
    house.settled(page)
    moment = house.state_of(page)["sun"]
    assert moment["kind"] == "moment"
    house.until(page, "document.querySelector('#sun .sun-note').textContent !== ''")
    page.locator(".dome-sun").focus()
    page.keyboard.press("ArrowUp")
    house.settled(page)
    assert house.state_of(page)["sun"]["kind"] == "direction"


def test_another_technique_changes_the_picture(page: Page) -> None:
    before = picture(page)
    slot = page.locator("[data-slot='height_shading']")
    slot.locator(".slot-button").click()
    slot.locator("input[value='empirical']").check()
    house.settled(page)
    assert house.state_of(page)["height_shading"]["kind"] == "empirical"
    assert changed_share(before, picture(page)) > 0.1


def test_a_refused_value_is_told_at_its_control_and_changes_nothing(page: Page) -> None:
    before = house.state_of(page)["view"]["exposure"]
    control = page.locator("[data-path='view.exposure']")
    entry = control.locator("input.entry")
    for wrong in ("1e9", "many"):
        entry.fill(wrong)
        entry.press("Enter")
        house.until(page, "document.querySelector('[data-path=\"view.exposure\"] .field-error').textContent !== ''")
        house.until(page, "umbrage.link.sent.length === 0")
        assert control.locator(".field-error").is_visible()
        assert house.state_of(page)["view"]["exposure"] == before
    entry.fill("1")
    entry.press("Enter")
    house.settled(page)
    assert house.state_of(page)["view"]["exposure"] == 1
    assert control.locator(".field-error").is_hidden()


def test_undo_and_redo_by_keyboard(page: Page) -> None:
    azimuth = house.state_of(page)["camera"]["azimuth"]
    page.locator("#surface").focus()
    page.keyboard.press("ArrowRight")
    house.settled(page)
    turned = house.state_of(page)["camera"]["azimuth"]
    assert turned != azimuth
    page.keyboard.press("Control+z")
    house.settled(page)
    assert house.state_of(page)["camera"]["azimuth"] == azimuth
    page.keyboard.press("Control+Shift+z")
    house.settled(page)
    assert house.state_of(page)["camera"]["azimuth"] == turned


def test_two_sessions_have_their_own_cameras(open_page: Open) -> None:
    first, second = open_page(), open_page()
    drag(first, (500, 300), (640, 300))
    house.settled(first)
    house.settled(second)
    one, two = house.state_of(first)["camera"], house.state_of(second)["camera"]
    assert one["azimuth"] != two["azimuth"]
    assert changed_share(picture(first), picture(second)) > 0.2


def test_a_pinch_comes_closer(open_page: Open) -> None:
    page = open_page(viewport={"width": 390, "height": 844}, has_touch=True, device_scale_factor=0.5)
    distance = house.state_of(page)["camera"]["distance"]
    touch = page.context.new_cdp_session(page)

    def send(kind: str, spread: float) -> None:
        fingers = [] if kind == "touchEnd" else [-spread, spread]
        points = [{"x": 195 + x, "y": 300, "id": i} for i, x in enumerate(fingers)]
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    send("touchStart", 40)
    for spread in (50, 60, 70, 80):
        send("touchMove", spread)
    send("touchEnd", 0)
    house.settled(page)
    assert house.state_of(page)["camera"]["distance"] == pytest.approx(distance / 2, rel=0.02)


def test_a_lost_connection_comes_back_with_the_state(page: Page) -> None:
    drag(page, (500, 300), (600, 320))
    house.settled(page)
    before = house.state_of(page)
    page.evaluate("umbrage.link.socket.close()")
    house.until(page, "document.querySelector('#stage').classList.contains('away')")
    assert page.locator("#notices .line").is_visible()
    house.until(page, "umbrage.link.ready && !document.querySelector('#stage').classList.contains('away')")
    house.until(page, "umbrage.stats.idle")
    assert house.state_of(page) == before
    assert page.locator("#notices .line").is_hidden()


def test_a_restarted_server_gets_the_state_back(page: Page, service: house.Service) -> None:
    page.locator("#surface").focus()
    page.keyboard.press("ArrowUp")
    house.settled(page)
    before, frames = house.state_of(page), page.evaluate("umbrage.stats.frames")
    service.stop()
    house.until(page, "!umbrage.link.ready")
    service.start()
    house.until(page, f"umbrage.link.ready && umbrage.stats.frames > {frames} && umbrage.stats.idle")
    assert house.state_of(page) == before


def test_a_link_carries_the_whole_state(page: Page, open_page: Open) -> None:
    drag(page, (500, 300), (560, 330))
    house.settled(page)
    address = page.evaluate("umbrage.encode()")
    other = open_page()
    other.goto("about:blank")
    other.goto(address)
    house.until(other, "umbrage.store.document !== null && umbrage.stats.frames > 0")
    assert house.state_of(other) == house.state_of(page)


def test_a_link_of_version_one_keeps_its_brightness(open_page: Open, document: dict[str, Any]) -> None:
    page = open_page({**document, "version": 1, "view": {"exposure": -7.4}})
    view = house.state_of(page)["view"]
    assert view["auto_exposure"] is False
    assert view["exposure"] == pytest.approx(-7.4 + np.log2(1000 / np.pi))
    assert not page.get_by_role("switch", name="Follow the light").is_checked()


def test_a_damaged_link_is_told_and_the_scene_still_comes(open_page: Open, document: dict[str, Any]) -> None:
    page = open_page({**document, "camera": {**document["camera"], "distance": -4}}, rest=False)
    house.until(page, "document.querySelector('.toast.refusal') !== null")
    assert "distance" in page.locator(".toasts").inner_text()
    assert house.state_of(page)["camera"]["distance"] > 0


def test_comparison_streams_the_other_technique(page: Page) -> None:
    page.get_by_role("button", name="Compare", exact=True).click()
    assert page.get_by_role("combobox", name="B uses").input_value() == "", "nothing is compared before it is chosen"
    assert page.get_by_role("button", name="Stop comparing").is_hidden()
    assert page.get_by_role("radio", name="Blink").is_hidden()
    page.locator("#compare select").first.select_option("height_shading")
    house.until(page, "document.querySelector('#stage').dataset.compare === 'split'")
    house.until(page, "document.querySelector('#picture-b').width > 16")
    house.settled(page)
    assert page.locator(".split").is_visible()
    page.locator(".split").focus()
    page.keyboard.press("ArrowLeft")
    assert page.evaluate("umbrage.compare.at") == pytest.approx(0.48)
    page.get_by_role("button", name="Stop comparing").click()
    assert page.locator(".split").is_hidden()
