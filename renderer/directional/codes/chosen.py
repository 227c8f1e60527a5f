"""For each point the code that misjudges it least: a ring of horizons, or one of three sets of books, in nine bytes.

What shades points differs: land stands on their horizon, leaves hang over them, creases narrow their sky. The ring is
exact for the first; books are learnt for what is left, in three classes that start from how much light there is, each
point then going over to the set that misjudges it least (Linde, Buzo & Gray 1980, of classes). Bits 70 and 71 hold the
choice: 0 the ring, laid out as `HorizonRing` lays out nine bytes, else a set of books, of nine bits for sectors 0 to 5
and eight for 6 and 7, at `OFFSETS`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from renderer.directional.codes.bits import read_masks
from renderer.directional.codes.code import cells_of, get, put
from renderer.directional.codes.codebook import learnt, nearest_of, patterns_of, sectors_joined, words_of_books
from renderer.directional.codes.horizon_ring import HorizonRing
from renderer.directional.hemisphere import Hemisphere

SETS = 3
WIDTHS = (9,) * 6 + (8,) * 2
OFFSETS = tuple(sum(WIDTHS[:sector]) for sector in range(8))
CHOICE = 70
"""First bit of the choice."""

TAUGHT = 1 << 15
"""Most points that books are learnt of."""

ROUNDS = 2
"""In which points are drawn to sets anew."""


@dataclass(frozen=True)
class Chosen:
    """A ring or a set of books for each point; see `learn_sets`.

    Args:
        layout: of the masks. books: (3, 8, 512, cells + 1) booleans. blend: whether masks are blended between
            directions.
    """

    layout: Hemisphere
    books: np.ndarray
    blend: bool = True

    size = 9

    def encode(self, masks: np.ndarray) -> np.ndarray:
        """As `Code`."""
        ring = HorizonRing(self.layout)
        words = ring.encode(masks)
        wrong = ((ring.evaluate(words, cells_of(self.layout)) > 0.5) != masks).sum(axis=1)
        patterns = patterns_of(self.layout, masks)
        for number, books in enumerate(self.books, start=1):
            found, apart = _coded(patterns, books)
            better = apart < wrong
            put(found, CHOICE, 2, np.full(len(found), number))
            words[better], wrong = found[better], np.minimum(wrong, apart)
        return words

    def evaluate(self, words: np.ndarray, places: np.ndarray) -> np.ndarray:
        """As `Code`."""
        choice = get(words, CHOICE, 2)
        found = HorizonRing(self.layout).evaluate(words, places)
        for number, books in enumerate(self.books, start=1):
            mine = choice == number
            if mine.any():
                sectors = [
                    book[get(words[mine], OFFSETS[sector], WIDTHS[sector])] for sector, book in enumerate(books)
                ]
                masks = sectors_joined(self.layout, sectors)
                found[mine] = read_masks(self.layout, masks, places if places.ndim == 2 else places[mine], self.blend)
        return found

    def tables(self) -> dict[str, np.ndarray]:
        """`book` (24, 512, C) uint32: the sets' sectors one after another."""
        return {"book": words_of_books(self.books.reshape(-1, *self.books.shape[2:]))}


def learn_sets(layout: Hemisphere, masks: np.ndarray, blend: bool = True) -> Chosen:
    """Sets of books for a cloud's masks (M, count)."""
    taught = masks[:: -(-len(masks) // TAUGHT)]
    ring = HorizonRing(layout)
    missed = ((ring.evaluate(ring.encode(taught), cells_of(layout)) > 0.5) != taught).any(axis=1)
    # Where rings are exact for all, what there is still fills the books.
    taught = taught[missed] if missed.any() else taught[:1]
    patterns = patterns_of(layout, taught)
    order = np.argsort(np.argsort(taught.sum(axis=1), kind="stable"), kind="stable")
    own = order * SETS // len(taught)
    books = np.zeros((SETS, 8, 1 << WIDTHS[0], patterns.shape[2]), bool)
    for _ in range(ROUNDS):
        for number in range(SETS):
            mine = patterns[own == number]
            if len(mine):
                for sector, width in enumerate(WIDTHS):
                    book = learnt(mine[:, sector], 1 << width)
                    books[number, sector] = book[np.minimum(np.arange(1 << WIDTHS[0]), len(book) - 1)]
        own = np.argmin([_coded(patterns, books[number])[1] for number in range(SETS)], axis=0)
    return Chosen(layout, books, blend)


def _coded(patterns: np.ndarray, books: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Words (M, 3) of patterns (M, 8, n) by a set of books, without their choice, and misjudged cells (M,)."""
    words, apart = np.zeros((len(patterns), 3), np.uint32), np.zeros(len(patterns))
    for sector, width in enumerate(WIDTHS):
        number, wrong = nearest_of(patterns[:, sector], books[sector][: 1 << width])
        put(words, OFFSETS[sector], width, number)
        apart += wrong
    return words, apart
