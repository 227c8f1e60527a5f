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
    box.get_by_label("From", exact=True).fill("2024-06-21")
    box.get_by_label("To", exact=True).fill("2024-06-21")
    return box


def numbers_in(text: str) -> list[float]:
    return [float(word.replace(",", "")) for word in re.findall(r"[\d.,]*\d", text)]


def test_a_study_shows_maps_and_leaves_files(dialog: Locator) -> None:
    dialog.get_by_label("Step", exact=True).fill("60")
    dialog.get_by_label("Step", exact=True).press("Enter")
    dialog.get_by_role("button", name="Study the sun", exact=True).click()
    for name in ("hours", "insolation"):
        image = dialog.get_by_alt_text(f"Map of {name}, north up")
        expect(image).to_be_visible(timeout=60_000)
        assert image.evaluate("async (image) => { await image.decode(); return image.naturalWidth; }") == 512
    lowest, middle, highest, *_ = (numbers_in(text)[0] for text in dialog.locator(".scale-ends span").all_inner_texts())
    assert 0 <= lowest < middle < highest <= 15.5
    with dialog.page.expect_download() as kept:
        dialog.get_by_role("link", name="GeoTIFF").first.click()
    assert kept.value.suggested_filename == "hours_2024-06-21_2024-06-21.tif"


def test_what_is_wrong_is_said_in_the_dialog(dialog: Locator) -> None:
    dialog.get_by_label("To", exact=True).fill("2024-06-20")
    dialog.get_by_role("button", name="Study the sun", exact=True).click()
    expect(dialog.locator(".field-error:visible")).to_contain_text("lies before the first day", timeout=30_000)
    dialog.get_by_label("Time zone", exact=True).fill("Europe/Atlantis")
    dialog.get_by_role("button", name="Study the sun", exact=True).click()
    expect(dialog.locator(".field-error:visible")).to_contain_text("not a known time zone")


def test_a_study_is_cancelled_and_outlives_its_dialog(dialog: Locator) -> None:
    dialog.get_by_label("To", exact=True).fill("2025-06-20")
    dialog.get_by_label("On", exact=True).select_option("Canopy")
    dialog.get_by_role("button", name="Study the sun", exact=True).click()
    expect(dialog.locator(".progress-words")).to_contain_text("following the sun", timeout=30_000)
    dialog.page.keyboard.press("Escape")
    dialog.page.get_by_role("button", name="Study the sun over days").click()
    expect(dialog.locator("progress")).to_be_visible()
    dialog.get_by_role("button", name="Cancel").click()
    expect(dialog.locator("progress")).to_be_hidden()
    expect(dialog.locator(".field-error:visible")).to_have_count(0)
