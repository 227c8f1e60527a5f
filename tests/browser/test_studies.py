"""What the study found, on the page: cases of failure to open, tables to read, and the facts of every technique."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from renderer.failing import failures
from renderer.forest.phenomenon import SLOTS
from server.routes import study
from tests.browser import house

FACTS = {"error": 0.374, "worst": 0.62, "sun": 0.353, "sun_ms": 16.2, "camera": 0.952, "camera_ms": 44.0}
NUMBERS = [{"name": "depth_map_scintillates", "failing_now": 0.31, "surviving_now": 0.02}]
TABLE = "measured thus\n\n| technique | error |\n| --- | ---: |\n| **none** | 0.71 |\n"


@pytest.fixture
def found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A study that the project keeps."""
    files = {
        "techniques/facts.json": json.dumps({"slots": {"shadow": {"none": FACTS}}, "note": "Measured so."}),
        "failures/results.json": json.dumps(NUMBERS),
        "shadow/table.md": TABLE,
    }
    for name, text in files.items():
        path = tmp_path / "forest" / name
        path.parent.mkdir(parents=True)
        path.write_text(text)
    monkeypatch.setattr(study, "KEPT", tmp_path)


def unfold(page: Page) -> None:
    page.get_by_role("button", name="Failures, charts and tables").click()


@pytest.mark.usefixtures("found")
def test_a_case_opens_with_the_survivor_beside_it(page: Page) -> None:
    unfold(page)
    cards = page.locator(".case")
    expect(cards).to_have_count(len(failures("forest")), timeout=30_000)
    case = failures("forest")["depth_map_scintillates"]
    card = cards.filter(has_text=case.title)
    assert "31\u00a0%" in card.inner_text(), "what was measured last, not when it was written"
    assert case.cause in card.inner_text()
    card.click()
    expect(page.get_by_role("dialog")).to_be_hidden()
    house.until(page, "document.querySelector('#stage').dataset.compare === 'split'")
    assert house.state_of(page)["shadow"]["kind"] == "depth_shadow_map"
    assert page.locator(".tag").all_inner_texts() == ["Depth shadow map", "Double horizon map"]
    assert page.locator("#compare select").nth(1).input_value() == "double_horizon_map"
    before = house.state_of(page)["sun"]["azimuth"]
    # Noted in the page: from outside a busy machine would miss a step.
    page.evaluate("""umbrage.seen = [];
        umbrage.store.addEventListener('patch', () => umbrage.seen.push(umbrage.store.document.sun.azimuth))""")
    page.get_by_role("button", name="Play the sweep").click()
    house.until(page, "umbrage.seen.length >= 8")
    up = [before + 0.25 * turn for turn in (1, 2, 3, 4)]
    assert page.evaluate("umbrage.seen") == pytest.approx([*up, *up[-2::-1], before])
    page.get_by_role("button", name="Stop comparing").click()
    assert page.get_by_role("button", name="Play the sweep").count() == 0


@pytest.mark.usefixtures("found")
def test_tables_are_read_in_the_dialog(page: Page) -> None:
    unfold(page)
    page.get_by_text("Table: shadow").click(timeout=30_000)
    expect(page.locator("dialog table td")).to_have_text(["none", "0.71"])
    assert "measured thus" in page.locator("dialog details").inner_text()


@pytest.mark.usefixtures("found")
def test_every_technique_says_what_it_costs_and_how_wrong_it_is(page: Page) -> None:
    slot = page.locator("[data-slot='shadow']")
    told = "Error 37 %, worst 62 % · frame 16 ms (0.35 yardsticks) as the sun moves, 44 ms (0.95) as the camera does"
    expect(slot.locator(".slot-button .facts")).to_have_text(told)
    slot.locator(".slot-button").click()
    expect(slot.locator(".card").filter(has=page.locator("[value=none]")).locator(".facts")).to_have_text(told)
    assert "Measured so." in slot.inner_text()
    other = page.locator(f"[data-slot='{SLOTS[0].name}'] .slot-button .facts")
    assert other.inner_text() == "", "nothing is said where nothing was measured"
