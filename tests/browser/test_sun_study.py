"""A person studies the sun over the land that the page shows."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Locator, expect

from tests.browser.conftest import Open


@pytest.fixture
def dialog(open_page: Open) -> Locator:
    page = open_page()
    page.get_by_role("button", name="Study the sun over days").click()
    box = page.get_by_role("dialog")
    box.get_by_label("From").fill("2024-06-21")
    box.get_by_label("To", exact=True).fill("2024-06-21")
    return box


def numbers_in(text: str) -> list[float]:
    return [float(word.replace(",", "")) for word in re.findall(r"[\d.,]*\d", text)]


def test_a_study_shows_maps_and_leaves_files(dialog: Locator) -> None:
    dialog.get_by_text("More", exact=True).click()
    dialog.get_by_label("Step").fill("60")
    dialog.get_by_role("button", name="Study the sun", exact=True).click()
    image = dialog.locator("img.map")
    expect(image).to_be_visible(timeout=60_000)
    expect(image).to_have_attribute("alt", re.compile("Map of hours, north up"))
    lowest, middle, highest = (numbers_in(text)[0] for text in dialog.locator(".scale-ends span").all_inner_texts())
    assert 0 <= lowest < middle < highest <= 15.5
    with dialog.page.expect_download() as kept:
        dialog.get_by_role("link", name="GeoTIFF").click()
    assert kept.value.suggested_filename == "hours_2024-06-21_2024-06-21.tif"
    dialog.get_by_role("radio", name="Insolation").check(force=True)
    expect(image).to_have_attribute("alt", re.compile("Map of insolation"))
    line = dialog.locator("output")
    expect(line).to_contain_text("in the mean")
    image.hover()
    expect(line).to_contain_text(re.compile("Here|Under trees"))


def test_what_is_wrong_is_said_in_the_dialog(dialog: Locator) -> None:
    dialog.get_by_label("To", exact=True).fill("2024-06-20")
    dialog.get_by_role("button", name="Study the sun", exact=True).click()
    expect(dialog.locator(".field-error")).to_contain_text("end: lies before the first day", timeout=30_000)
    dialog.get_by_label("Latitude").fill("north")
    dialog.get_by_role("button", name="Study the sun", exact=True).click()
    expect(dialog.locator(".field-error")).to_contain_text("latitude")


def test_a_study_is_cancelled_and_outlives_its_dialog(dialog: Locator) -> None:
    dialog.get_by_label("To", exact=True).fill("2025-06-20")
    dialog.get_by_label("On", exact=True).select_option("canopy")
    dialog.get_by_role("button", name="Study the sun", exact=True).click()
    expect(dialog.locator(".progress-words")).to_contain_text("following the sun", timeout=30_000)
    dialog.page.keyboard.press("Escape")
    dialog.page.get_by_role("button", name="Study the sun over days").click()
    expect(dialog.locator("progress")).to_be_visible()
    dialog.get_by_role("button", name="Cancel").click()
    expect(dialog.locator("progress")).to_be_hidden()
    assert dialog.locator(".field-error").inner_text() == ""
