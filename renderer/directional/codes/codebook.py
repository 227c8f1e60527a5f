"""Sectors of a hemisphere by learnt patterns: the code that misjudges least in nine bytes (vector quantisation).

A hemisphere is cut into eight sectors, each an eighth of the azimuths at all elevations: 16 cells of 128. Shadows of
one subject repeat few of the 65,536 patterns that a sector could have, so for each sector a book of the cloud's own is
learnt (vector quantisation: Linde, Buzo & Gray 1980), and a point keeps one number a sector, of as many
bits as there are bytes: 2^9 patterns for nine. Field s of `size` bits, from bit s * size on, is sector s.

A pattern's cell `row * (azimuths / 8) + azimuth % (azimuths / 8)` is its bit of that number; the first sector's holds
the zenith behind its cells. Books are the cloud's, not a point's: 16 KB for nine bytes and 129 directions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from renderer.directional.codes.bits import read_masks
from renderer.directional.codes.code import get, put, word_count
from renderer.directional.hemisphere import Hemisphere

SECTORS = 8

TAUGHT = 1 << 16
"""Most points that a book is learnt of, evenly spread over the cloud's."""

TRIES = 16
"""Candidates for each next pattern of a book."""


@dataclass(frozen=True)
class Codebook:
    """One number a sector, with the books that they are looked up in; see `learn`.

    Args:
        layout: of the masks. size: bytes of a point, which are bits of a sector.
        books: (8, K, cells + 1) booleans, at most 2^size patterns a sector.
        blend: whether what lies between directions is blended.
    """

    layout: Hemisphere
    size: int
    books: np.ndarray
    blend: bool = True

    def encode(self, masks: np.ndarray) -> np.ndarray:
        """As `Code`."""
        words = np.zeros((len(masks), word_count(self.size)), np.uint32)
        patterns = patterns_of(self.layout, masks)
        for sector, book in enumerate(self.books):
            put(words, sector * self.size, self.size, nearest_of(patterns[:, sector], book)[0])
        return words

    def evaluate(self, words: np.ndarray, places: np.ndarray) -> np.ndarray:
        """As `Code`."""
        return read_masks(self.layout, self.masks(words), places, self.blend)

    def masks(self, words: np.ndarray) -> np.ndarray:
        """Masks (M, count) that words stand for."""
        found = [book[get(words, sector * self.size, self.size)] for sector, book in enumerate(self.books)]
        return sectors_joined(self.layout, found)

    def tables(self) -> dict[str, np.ndarray]:
        """`book` (8, K, C) uint32 as the GPU reads it: each pattern's words, C = 1 or 4."""
        return {"book": words_of_books(self.books)}


def learn(layout: Hemisphere, size: int, masks: np.ndarray, blend: bool = True) -> Codebook:
    """A codebook for a cloud's masks (M, count)."""
    patterns = patterns_of(layout, masks[:: -(-len(masks) // TAUGHT)])
    books = [learnt(patterns[:, sector], 1 << size) for sector in range(SECTORS)]
    most = max(len(book) for book in books)
    even = [np.concatenate([book, np.repeat(book[:1], most - len(book), axis=0)]) for book in books]
    return Codebook(layout, size, np.stack(even), blend)


def patterns_of(layout: Hemisphere, masks: np.ndarray) -> np.ndarray:
    """(M, 8, cells + 1) booleans of masks: each sector's cells, and the zenith in the first's last place."""
    rows, across = layout.elevations, layout.azimuths // SECTORS
    cut = masks[:, :-1].reshape(len(masks), rows, SECTORS, across).transpose(0, 2, 1, 3)
    patterns = np.zeros((len(masks), SECTORS, rows * across + 1), bool)
    patterns[..., :-1] = cut.reshape(len(masks), SECTORS, rows * across)
    patterns[:, 0, -1] = masks[:, -1]
    return patterns


def sectors_joined(layout: Hemisphere, patterns: list[np.ndarray]) -> np.ndarray:
    """Masks (M, count) of eight patterns (M, cells + 1)."""
    rows, across = layout.elevations, layout.azimuths // SECTORS
    cut = np.stack(patterns, axis=1)[..., :-1].reshape(-1, SECTORS, rows, across).transpose(0, 2, 1, 3)
    return np.concatenate([cut.reshape(-1, layout.count - 1), patterns[0][:, -1:]], axis=1)


def words_of_books(books: np.ndarray) -> np.ndarray:
    """Books (R, K, n) as words (R, K, C) uint32, C = 1 or 4."""
    packed = np.zeros((*books.shape[:2], 4 if books.shape[2] <= 32 else 16), np.uint8)
    bits = np.packbits(books, axis=2, bitorder="little")
    packed[..., : bits.shape[2]] = bits
    return np.asarray(packed.view("<u4"))


def nearest_of(patterns: np.ndarray, book: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Number (M,) of the book's pattern that differs least from each of (M, n), and in how many cells (M,)."""
    distinct, which, _ = _distinct(patterns)
    number, apart = _nearest(distinct, book)
    return number[which], apart[which]


def _distinct(patterns: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Patterns (M, n) that differ, (D, n); which of them each is, (M,); how often each is there, (D,)."""
    _, first, which, count = np.unique(_keys(patterns), return_index=True, return_inverse=True, return_counts=True)
    return patterns[first], which, count


def _words(patterns: np.ndarray) -> np.ndarray:
    """Patterns (M, n) as bits of words (M, W)."""
    kind = np.dtype(np.uint32 if patterns.shape[1] <= 32 else np.uint64)
    packed = np.zeros((len(patterns), kind.itemsize * -(-patterns.shape[1] // (8 * kind.itemsize))), np.uint8)
    bits = np.packbits(patterns, axis=1)
    packed[:, : bits.shape[1]] = bits
    return packed.view(kind)


def _keys(patterns: np.ndarray) -> np.ndarray:
    """One value (M,) a pattern (M, n), equal where these are."""
    words = _words(patterns)
    # Numbers sort faster than what holds several.
    return words[:, 0] if words.shape[1] == 1 else words.view(np.dtype((np.void, words.shape[1] * 8))).ravel()


def _differing(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Bits (D, K) uint8 in which words (D, W) differ from words (K, W)."""
    found = np.bitwise_count(one[:, None, 0] ^ other[:, 0])
    for word in range(1, other.shape[1]):
        found += np.bitwise_count(one[:, None, word] ^ other[:, word])
    return np.asarray(found)


def _nearest(patterns: np.ndarray, book: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The book's pattern that differs least from each of (D, n): its number (D,), and in how many cells (D,)."""
    number, apart = np.empty(len(patterns), np.int64), np.empty(len(patterns), np.uint8)
    given, own = _words(patterns), _words(book)
    for start in range(0, len(given), 1 << 11):
        part = given[start : start + (1 << 11)]
        differing = _differing(part, own)
        best = differing.argmin(axis=1)
        number[start : start + len(part)] = best
        apart[start : start + len(part)] = differing[np.arange(len(part)), best]
    return number, apart


def learnt(patterns: np.ndarray, most: int, tries: int = TRIES) -> np.ndarray:
    """At most so many patterns (K, n) that misjudge few cells of those given (M, n).

    They are taken one after another, each time that of some candidates which lessens what is misjudged most; candidates
    are drawn where much is. From such a book, or from the commonest patterns, rounds of majorities (Linde, Buzo & Gray
    1980) gain nothing any more, and from the latter alone a tenth more is misjudged.
    """
    distinct, _, count = _distinct(patterns)
    order = np.argsort(-count, kind="stable")
    if len(distinct) <= most:
        return np.asarray(distinct[order])
    words, weight = _words(distinct), count.astype(np.float32)
    taken = [int(order[0])]
    apart = _differing(words, words[taken])[:, 0].astype(np.float32)
    rng = np.random.default_rng(len(distinct))
    while len(taken) < most:
        left = np.cumsum(apart * weight, dtype=np.float64)
        tried = np.searchsorted(left, rng.random(tries) * left[-1], side="right")
        nearer = np.minimum(_differing(words, words[tried]), apart[:, None])
        best = int((weight @ nearer).argmin())
        taken.append(int(tried[best]))
        apart = nearer[:, best]
    return np.asarray(distinct[taken])
