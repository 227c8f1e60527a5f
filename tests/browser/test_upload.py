"""A person brings a terrain: what the file leaves unsaid is asked for before it replaces anything."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image
from playwright.sync_api import Page

from tests.browser import house

ROW, COLUMN = np.mgrid[-40:41, -50:51]
HILL = np.exp(-(ROW**2 + COLUMN**2) / 600).astype(np.float32)


def bring(page: Page, path: Path) -> None:
    """Choose a file, and wait for the dialog that says what it is."""
    page.set_input_files("input[type=file]", str(path))
    page.locator("#dialog").wait_for(state="visible")


def use(page: Page) -> None:
    page.get_by_role("button", name="Use for: terrain").click()


def test_a_picture_of_heights_is_asked_for_its_cells_and_heights(page: Page, tmp_path: Path) -> None:
    Image.fromarray((HILL * 65535).astype(np.uint16)).save(tmp_path / "hill.png")
    bring(page, tmp_path / "hill.png")
    dialog = page.locator("#dialog")
    dialog.get_by_label("Cell size, x").fill("60")
    dialog.get_by_label("Cell size, y").fill("60,5")
    dialog.get_by_label("Lowest elevation").fill("−20")
    use(page)
    assert "Highest elevation" in page.get_by_role("alert").filter(visible=True).inner_text()
    dialog.get_by_label("Highest elevation").fill("400")
    use(page)
    house.settled(page)
    house.until(page, "umbrage.store.document.terrain.kind === 'asset'")
    reading = house.state_of(page)["terrain"]["reading"]
    assert reading == {"cell_size": [60, 60.5], "elevation_low": -20, "elevation_high": 400, "holes": "refuse"}


def test_a_terrain_with_holes_is_filled_where_its_owner_wants_it(page: Page, tmp_path: Path) -> None:
    np.savez(tmp_path / "holed.npz", elevation=np.where(HILL > 0.9, np.nan, HILL * 300), cell_size=(60.0, 60.0))
    bring(page, tmp_path / "holed.npz")
    assert "holes" in page.locator("#dialog p").inner_text()
    page.get_by_role("button", name="Fill the holes").click()
    page.get_by_text("were filled").wait_for()
    use(page)
    house.settled(page)
    house.until(page, "umbrage.store.document.terrain.kind === 'asset'")
    assert house.state_of(page)["terrain"]["reading"]["holes"] == "fill"


def test_a_picture_of_species_is_offered_as_a_map(page: Page, tmp_path: Path) -> None:
    Image.fromarray(np.array([[1, 2], [3, 0]], np.uint8)).save(tmp_path / "species.png")
    bring(page, tmp_path / "species.png")
    assert page.get_by_role("button", name="Use for: density map").is_visible()
    assert not page.get_by_role("button", name="Use for: terrain").count()
    page.get_by_role("button", name="Use for: species map").click()
    house.until(page, "umbrage.store.document.cover.species_map.startsWith('asset:')")
    page.evaluate("umbrage.store.change({ cover: { species_map: '' } }, 'test')")  # nothing is to be planted for this
