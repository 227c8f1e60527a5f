"""The page by the rules of WCAG 2.1 AA, as far as a checker can tell."""

from __future__ import annotations

from typing import Any

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page

from tests.browser.conftest import Open

RULES = {"runOnly": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "best-practice"]}
PHONE = {"viewport": {"width": 390, "height": 844}, "has_touch": True}


def violations(page: Page) -> list[tuple[str, list[Any]]]:
    """Rule and elements of each violation."""
    found = Axe().run(page, options=RULES).response["violations"]
    return [(item["id"], [node["target"] for node in item["nodes"]]) for item in found]


def open_everything(page: Page) -> None:
    """Every panel that can be open at once."""
    page.get_by_role("button", name="Compare", exact=True).click()
    page.get_by_role("button", name="What a picture costs").click()
    page.get_by_role("button", name="Sun, date and place in numbers").click()
    page.locator(".slot-button").first.click()
    folded = page.locator("details:not([open]) > summary")
    while folded.count():
        folded.first.click()


@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_no_violation_with_every_panel_open(open_page: Open, scheme: str) -> None:
    page = open_page(color_scheme=scheme, bypass_csp=True)
    assert violations(page) == []
    open_everything(page)
    assert violations(page) == []
    page.get_by_role("button", name="As code").click()
    page.locator(".snippet").first.wait_for()
    assert violations(page) == []
    page.keyboard.press("Escape")
    page.get_by_role("button", name="Failures, charts and tables").click()
    page.locator(".case").first.wait_for()
    assert violations(page) == []


def test_no_violation_on_a_phone(open_page: Open) -> None:
    page = open_page(**PHONE, device_scale_factor=0.5, bypass_csp=True)
    assert violations(page) == []
    page.get_by_role("button", name="Techniques and parameters").click()
    assert violations(page) == []


def test_every_control_is_reached_by_keyboard(open_page: Open) -> None:
    page = open_page()
    reached = set()
    page.locator("#surface").focus()
    while "What a picture costs" not in reached:  # the last one; a page that traps the focus runs into the timeout
        page.keyboard.press("Tab")
        reached.add(page.evaluate("document.activeElement.getAttribute('aria-label') ?? document.activeElement.id"))
    everything = page.evaluate("""[...document.querySelectorAll('button, input, select, summary, [tabindex="0"]')]
        .filter((item) => item.checkVisibility({visibilityProperty: true}) && !item.disabled && item.tabIndex >= 0)
        .filter((item) => !['radio', 'file'].includes(item.type) && item.id !== 'surface')
        .map((item) => item.getAttribute('aria-label') ?? item.id)""")
    assert set(everything) - reached == set()


def test_the_checker_sees_a_spoiled_page(open_page: Open) -> None:
    page = open_page(bypass_csp=True)
    page.evaluate("document.querySelector('#tools button').removeAttribute('aria-label')")
    page.evaluate("document.querySelector('#tools button').removeAttribute('title')")
    assert "button-name" in [rule for rule, _ in violations(page)]
