"""Pictures of every preset, panel and state of the page, phone and desktop, dark and light: `make screenshots`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, Page, sync_playwright

from tests.browser import house

OUT = Path(__file__).resolve().parents[2] / "out" / "screenshots"
DEVICES: dict[str, dict[str, Any]] = {
    "desktop": {"viewport": {"width": 1440, "height": 900}},
    "phone": {"viewport": {"width": 390, "height": 844}, "has_touch": True, "device_scale_factor": 2},
}
Act = Callable[[Page], None]
SCHEMES = ("dark", "light")
QUALITY = {"kind": "samples", "n": 8}


def button(page: Page, name: str) -> None:
    """Click a button by what it is called."""
    page.get_by_role("button", name=name, exact=True).click()


def compare(page: Page) -> None:
    """Two techniques beside each other."""
    button(page, "Compare")
    page.locator("#compare select").first.select_option("shadow")
    house.until(page, "document.querySelector('#picture-b').width > 16")
    house.settled(page)


def difference(page: Page) -> None:
    """Their difference."""
    compare(page)
    page.get_by_role("radio", name="Difference").check()


def cards(page: Page) -> None:
    """The techniques of a slot."""
    panel(page)
    page.locator("[data-slot='shadow'] .slot-button").click()


def panel(page: Page) -> None:
    """Techniques and parameters, which a phone hides at first."""
    if page.locator("#panel").is_hidden():
        button(page, "Techniques and parameters")


def folds(page: Page) -> None:
    """Every group of parameters."""
    panel(page)
    folded = page.locator("details:not([open]) > summary")
    while folded.count():
        folded.first.click()
    page.locator("#controls").evaluate("(body) => body.scrollTo(0, body.scrollHeight)")


def refused(page: Page) -> None:
    """A value out of its range."""
    panel(page)
    entry = page.locator("[data-path='view.exposure'] input.entry")
    entry.fill("1000")
    entry.press("Enter")
    house.until(page, "document.querySelector('[data-path=\"view.exposure\"] .field-error').textContent !== ''")


def lost(page: Page) -> None:
    """The connection is away."""
    page.evaluate("umbrage.link.connect = () => undefined; umbrage.link.socket.close()")
    house.until(page, "document.querySelector('#stage').classList.contains('away')")
    page.wait_for_timeout(400)


def point(page: Page) -> None:
    """What lies at the middle of the picture."""
    page.locator("#surface").focus()
    page.keyboard.press("Enter")
    house.until(page, "!document.querySelector('#probe').hidden")


def gallery(page: Page) -> None:
    """The strip of presets."""
    button(page, "Scenes and presets")
    house.until(page, "[...document.querySelectorAll('#gallery img')].every((image) => image.naturalWidth > 0)")


def studies(page: Page) -> None:
    """Cases of failure, charts and tables."""
    button(page, "Failures, charts and tables")
    page.locator(".case").first.wait_for()


def failure(page: Page) -> None:
    """A case of failure beside what survives."""
    studies(page)
    page.locator(".case").first.click()
    house.until(page, "document.querySelector('#stage').hasAttribute('data-beside')")
    house.settled(page)


def shell(page: Page) -> None:
    """The shell editor, with conflicts over the picture."""
    button(page, "Edit the shell")
    page.get_by_role("radio", name="Conflicts").check()
    house.until(page, "umbrage.editor?.outline != null")


def bare(page: Page) -> None:
    """Nothing but the picture."""
    page.locator("#surface").focus()
    page.keyboard.press("h")


STATES: dict[str, Act] = {
    "gallery": gallery, "techniques": cards, "parameters": folds, "compare": compare, "difference": difference,
    "studies": studies, "failure": failure, "refused": refused, "lost": lost, "point": point, "bare": bare,
    "costs": lambda page: button(page, "What a picture costs"),
    "sun": lambda page: button(page, "Sun, date and place in numbers"),
    "code": lambda page: button(page, "As code"),
    "export": lambda page: button(page, "Export"),
    "help": lambda page: button(page, "Help"),
}


def take(browser: Browser, address: str, options: dict[str, Any], path: Path, act: Act | None) -> None:
    """One picture: open an address, wait for rest, do something, and shoot."""
    context = browser.new_context(**options)
    page = context.new_page()
    page.goto(address)
    house.until(page, "window.umbrage !== undefined && umbrage.store.document !== null && umbrage.stats.frames > 0")
    house.settled(page)
    if act is not None:
        act(page)
    page.screenshot(path=path, animations="disabled")
    context.close()


def main(arguments: list[str] | None = None) -> int:
    """Take the pictures whose name contains the given text, all by default."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("only", nargs="?", default="", help="part of the names wanted, as desktop-dark or gallery")
    parser.add_argument("--scene", default="forest")
    wanted = parser.parse_args(arguments)
    OUT.mkdir(parents=True, exist_ok=True)
    with house.service() as service, sync_playwright() as playwright:
        browser = house.launch(playwright)
        presets = service.session.describe(wanted.scene)["presets"]
        first = next(iter(presets.values()))["document"]
        shots: list[tuple[str, dict[str, Any], Act | None]] = [
            *((name, preset["document"], None) for name, preset in presets.items()),
            *((name, first, act) for name, act in STATES.items()),
            *([("editor", presets["teapot_relief"]["document"], shell)] if wanted.scene == "shells" else []),
        ]
        for device, options in DEVICES.items():
            for scheme in SCHEMES:
                for name, document, act in shots:
                    path = OUT / f"{device}-{scheme}-{name}.png"
                    if wanted.only not in path.stem:
                        continue
                    address = house.link(service.address, {**document, "quality": QUALITY})
                    take(browser, address, {**options, "color_scheme": scheme}, path, act)
                    sys.stdout.write(f"{path}\n")
        browser.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
