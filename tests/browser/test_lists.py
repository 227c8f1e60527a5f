"""Lists of the document on the page: things beside a shell, and key frames on their track, by mouse, finger and key."""

from __future__ import annotations

from typing import Any

import pytest
from playwright.sync_api import Page

from tests.browser import house
from tests.browser.conftest import Open
from tests.browser.test_accessibility import violations
from tests.browser.test_shell_editor import QUICK, edit

KEYS = {"period": 10.0, "keys": [{"at": 0.0}, {"at": 4.0, "growth": 0.5, "bend": 40.0}]}
CORNER = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"


@pytest.fixture(scope="module")
def keyed(service: house.Service) -> dict[str, Any]:
    """A tube with two key frames, soon baked and drawn."""
    return service.session.state("shells", sets={**QUICK, "course": KEYS}).model_dump(mode="json")


def keys(page: Page) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = house.state_of(page)["course"]["keys"]
    return found


def things(page: Page) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = house.state_of(page)["things"]["list"]
    return found


def test_things_are_added_changed_refused_and_taken_out(open_page: Open, keyed: dict[str, Any]) -> None:
    page = open_page(keyed, bypass_csp=True)
    page.locator("#controls summary").get_by_text("Other things", exact=True).click()
    adder = page.get_by_role("combobox", name="Add to things")
    adder.select_option("ball")
    adder.select_option("box")
    assert [thing["kind"] for thing in things(page)] == ["ball", "box"]
    width = page.locator("[data-path='things.list.1.width'] input.entry")
    width.fill("0.75")
    width.press("Enter")
    assert things(page)[1]["width"] == 0.75
    assert things(page)[0]["radius"] == 0.25, "its neighbour stays as it is"
    width.fill("5000")
    width.press("Enter")
    house.until(page, "document.querySelector('#controls .refused .field-error')?.textContent.includes('1000')")
    house.settled(page)
    assert things(page)[1]["width"] == 0.75
    page.locator("[data-path='things.list.1.width'] .reset").click()
    assert things(page)[1]["width"] == 0.5
    assert violations(page) == []
    page.set_input_files("input[type=file]", {"name": "c.obj", "mimeType": "text/plain", "buffer": CORNER.encode()})
    page.get_by_role("button", name="Use for: one more of things").click()
    assert things(page)[2]["asset"].startswith("asset:")
    page.locator("[data-path='things.list'] summary").first.click()
    page.get_by_role("button", name="Take ball out").click()
    assert [thing["kind"] for thing in things(page)] == ["box", "asset"]
    page.get_by_role("button", name="Undo", exact=True).click()
    assert len(things(page)) == 3
    house.settled(page)


def test_key_frames_are_added_moved_and_taken_out(open_page: Open, keyed: dict[str, Any]) -> None:
    page = open_page(keyed, bypass_csp=True)
    edit(page)
    head = page.get_by_role("slider", name="Time within the round")
    head.fill("2")
    page.get_by_role("button", name="Add here").click()
    made = keys(page)[2]
    assert (made["at"], made["growth"], made["bend"]) == (2, 0.75, 20), "what the others say there"
    mark = page.get_by_role("button", name="Key frame at 2 s")
    mark.focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Shift+ArrowRight")
    assert keys(page)[2]["at"] == 3.1
    box = page.locator(".key-marks").bounding_box()
    assert box is not None
    middle = box["y"] + box["height"] / 2
    page.mouse.move(box["x"] + 0.31 * box["width"], middle)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.75 * box["width"], middle, steps=4)
    page.mouse.up()
    assert keys(page)[2]["at"] == pytest.approx(7.5, abs=0.1)
    opacity = page.locator("#editor [data-path='course.keys.2.opacity'] input.entry")
    opacity.fill("0.5")
    # Time that runs, or the server's answer to the change before, must not put the old number back under one's hands.
    page.evaluate("umbrage.store.change({ time: 1.5 }, 'time')")
    page.evaluate("new Promise((drawn) => setTimeout(() => requestAnimationFrame(drawn), 200))")
    assert opacity.input_value() == "0.5"
    opacity.press("Enter")
    assert keys(page)[2]["opacity"] == 0.5
    page.get_by_role("radio", name="Interpolated").check()
    assert house.state_of(page)["motion"] == {"kind": "keys", "planes": "interpolated"}
    assert violations(page) == []
    before = house.state_of(page)["time"]
    page.locator(".key-frames").get_by_role("button", name="Let time run").click()
    house.until(page, f"umbrage.store.document.time !== {before}")
    page.locator(".key-frames").get_by_role("button", name="Hold time").click()
    page.locator(".key-mark").nth(2).focus()
    page.keyboard.press("Delete")
    assert [key["at"] for key in keys(page)] == [0, 4]
    house.settled(page)


def test_a_finger_moves_a_key_frame_on_a_phone(open_page: Open, keyed: dict[str, Any]) -> None:
    page = open_page(keyed, viewport={"width": 390, "height": 844}, has_touch=True)
    edit(page)
    page.locator(".key-marks").scroll_into_view_if_needed()
    box = page.locator(".key-marks").bounding_box()
    assert box is not None
    hand = page.context.new_cdp_session(page)
    for kind, share in (("touchStart", 0.4), ("touchMove", 0.5), ("touchMove", 0.6), ("touchEnd", None)):
        places = [] if share is None else [{"x": box["x"] + share * box["width"], "y": box["y"] + 13}]
        hand.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": places})
    assert keys(page)[1]["at"] == pytest.approx(6, abs=0.2)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    house.settled(page)
