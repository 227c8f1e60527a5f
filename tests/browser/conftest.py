from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, sync_playwright

from tests.browser import house

DESK = {"width": 1280, "height": 800}
SMALL = 0.25
"""Device pixels per CSS pixel: the page at its full size with pictures of 320 x 200, which software draws quickly."""

Open = Callable[..., Page]


@pytest.fixture(scope="package")
def service() -> Iterator[house.Service]:
    with house.service() as served:
        yield served


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        opened = house.launch(playwright)
        yield opened
        opened.close()


@pytest.fixture(scope="package")
def document(service: house.Service) -> dict[str, Any]:
    """A state that is drawn quickly: no shadow, two samples, the sun by direction."""
    sun = {"kind": "direction", "azimuth": 150.0, "elevation": 40.0}
    sets = {"shadow.kind": "none", "quality": {"kind": "samples", "n": 2}, "sun": sun}
    return service.session.state("forest", sets=sets).model_dump(mode="json")


@pytest.fixture
def open_page(service: house.Service, browser: Browser, document: dict[str, Any]) -> Iterator[Open]:
    """Opens the page in a fresh browser context and waits for rest; any error of the page fails the test."""
    contexts: list[BrowserContext] = []
    errors: list[str] = []

    def go(state: dict[str, Any] | None = None, *, rest: bool = True, **options: Any) -> Page:
        context = browser.new_context(**{"viewport": DESK, "device_scale_factor": SMALL, **options})
        contexts.append(context)
        page = context.new_page()
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.goto(house.link(service.address, state or document))
        house.until(page, "window.umbrage !== undefined && umbrage.store.document !== null")
        if rest:
            house.until(page, "umbrage.stats.frames > 0")
            house.settled(page)
        return page

    yield go
    for context in contexts:
        context.close()
    assert errors == []


@pytest.fixture
def page(open_page: Open) -> Page:
    return open_page()
