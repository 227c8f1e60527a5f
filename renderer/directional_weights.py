"""Converged pictures of the directional textures as sums over their points, so that a study sees many suns in no time.

Which points a pixel shows depends on the view alone, what a point sends to a fixed eye on the light alone, and a
picture is linear in it. A view's weights are therefore found once, at all positions within the pixels, and every light
is one pass over the points and a product with a sparse matrix.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from scipy.sparse import csr_array

from renderer.core.cache import key_of
from renderer.directional.casting import AXES, NONE
from renderer.directional.facing import faces_seen
from renderer.world.camera import rays
from renderer.world.sampling import offset

if TYPE_CHECKING:
    from renderer.core.technique import BakedArrays
    from renderer.directional_partial import Partial
    from renderer.gl.context import GL

WEIGHTS_KEPT, LIGHTS_KEPT, DRAWN_KEPT = 48, 16, 6
"""Of views' weights, of points' light, and of what texels count in a picture, in memory."""

NO_PART_OF_LIGHT = {"visibility", "selection", "view", "quality", "version"}
"""Of a document: what a point sends to the eye does not depend on it."""


class Weighed:
    """Pictures without a background, each the same but for rounding as `Partial.drawn` gives.

    Args:
        partial: draws and bakes. size: of a picture's sides [px]. positions: within a pixel.
    """

    def __init__(self, partial: Partial, size: int, positions: int) -> None:
        self.partial, self.size, self.positions = partial, size, positions
        self._weights: OrderedDict[Hashable, csr_array] = OrderedDict()
        self._lights: OrderedDict[Hashable, np.ndarray] = OrderedDict()
        self._drawn: OrderedDict[Hashable, csr_array] = OrderedDict()

    def linear(self, state: Any) -> np.ndarray:
        """(size, size, 4) premultiplied radiance of a state, row 0 at the top."""
        weights, light = self.weights(state), self.light(state)
        picture = np.concatenate([weights @ light, weights.sum(axis=1)[:, None]], axis=1)
        return np.asarray(picture.reshape(self.size, self.size, 4))

    def weights(self, state: Any) -> csr_array:
        """What each point counts in each pixel, (pixels, points), row after row from the top."""
        cloud, subject = state.cloud.model_dump(mode="json"), state.subject.model_dump(mode="json")
        shown = [part.model_dump(mode="json") for part in (state.camera, state.visibility, state.selection)]
        return kept(self._weights, key_of(cloud, subject, *shown), WEIGHTS_KEPT, lambda: self._weighed(state))

    def light(self, state: Any) -> np.ndarray:
        """What each point sends to the eye (points, 3), W m-2 sr-1."""

        def make() -> np.ndarray:
            baked = self.partial.baked(state)
            lit = self.partial.session.gl.call(lambda gl: self.partial.renderer.lit(state, baked))
            return np.asarray(lit, np.float64)

        document = state.model_dump(mode="json", exclude=NO_PART_OF_LIGHT)
        return kept(self._lights, key_of(document), LIGHTS_KEPT, make)

    def _weighed(self, state: Any) -> csr_array:
        baked = self.partial.baked(state)
        count = len(baked["visibility"].arrays["used"])
        if state.selection.per_pixel:
            return self.partial.session.gl.call(self._of_pixels, state, baked, count)
        chosen = self.partial.session.gl.call(self._of_texels, state, baked, count)
        box = np.asarray(baked["visibility"].arrays["box"], np.float64)
        of = state.camera, box, state.visibility.texels, state.selection.magnification == "linear"
        key = str((state.camera, box.tolist(), *of[2:]))
        return csr_array(kept(self._drawn, key, DRAWN_KEPT, lambda: self._of_strips(*of)) @ chosen)

    def _of_strips(self, camera: Any, box: np.ndarray, texels: int, linear: bool) -> csr_array:
        """What each texel of the faces' strips counts in each pixel."""
        shares = [texel_shares(camera, box, texels, self.size, offset(each), linear) for each in range(self.positions)]
        pixels, taken, weights = (np.concatenate(part) for part in zip(*shares, strict=True))
        return csr_array((weights / self.positions, (pixels, taken)), (self.size**2, 3 * texels**2))

    def _of_pixels(self, gl: GL, state: Any, baked: dict[str, BakedArrays], count: int) -> csr_array:
        """Where pixels choose: a point each, at every position."""
        seen = []
        for sample in range(self.positions):
            atlas = self.partial.renderer.choose(state, baked, (self.size, self.size), offset(sample)).atlas
            seen.append(atlas.chosen_points()[::-1].reshape(-1))
        points = np.concatenate(seen)
        shown = np.flatnonzero(points != NONE)
        weights = np.full(len(shown), 1 / self.positions)
        return csr_array((weights, (shown % self.size**2, points[shown].astype(np.int64))), (self.size**2, count))

    def _of_texels(self, gl: GL, state: Any, baked: dict[str, BakedArrays], count: int) -> csr_array:
        """Where texels choose: what each point counts in each of them."""
        atlas = self.partial.renderer.choose(state, baked, (self.size, self.size), (0.5, 0.5)).atlas
        points, weights = atlas.chosen_points(), atlas.chosen_weights().astype(np.float64)
        row, column, place = np.nonzero(points != NONE)
        texels = row * points.shape[1] + column
        taken = weights[row, column, place], (texels, points[row, column, place].astype(np.int64))
        return csr_array(taken, (points.shape[0] * points.shape[1], count))


def texel_shares(
    camera: Any, box: np.ndarray, texels: int, size: int, at: tuple[float, float], linear: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Which texels of the faces' strips a picture shows, as the stage that draws it reads them.

    Args:
        camera: of the state. box: (2, 3) [m]. texels: of a face's side. size: of the picture's sides [px].
        at: within the pixels. linear: whether it reads between texels.

    Returns:
        Pixels, row after row from the top; texels, row after row of the strips side by side; what each counts.
    """
    cast = rays(camera, size, size, at)
    origins, directions = (np.broadcast_to(part, (size, size, 3)).reshape(-1, 3) for part in cast)
    with np.errstate(divide="ignore"):
        planes = (box[:, None] - origins) / directions
    near, far = planes.min(axis=0), planes.max(axis=0)
    enters = near.max(axis=1)
    pixel = np.flatnonzero((enters > 0) & (far.min(axis=1) > enters))
    axis = near[pixel].argmax(axis=1)
    side = 2 * axis + (np.take_along_axis(directions[pixel], axis[:, None], 1)[:, 0] < 0)
    strips = np.full(6, -1)
    seen = faces_seen(camera, box)
    strips[seen] = range(len(seen))
    place = (origins[pixel] + enters[pixel, None] * directions[pixel] - box[0]) / (box[1] - box[0])
    first = np.take_along_axis(place, np.array(AXES)[side], 1)[:, :2] * texels
    shown = strips[side] >= 0
    pixel, strip = pixel[shown], strips[side][shown]
    inside = np.clip(first[shown], 0.5, texels - 0.5) - (0.5 if linear else 0.0)
    low = np.minimum(inside.astype(np.int64), texels - 1)
    share = inside - low if linear else np.zeros_like(inside)
    found = []
    for right, up in ((0, 0), (1, 0), (0, 1), (1, 1)) if linear else ((0, 0),):
        column, row = (np.minimum(low[:, k] + step, texels - 1) for k, step in enumerate((right, up)))
        weight = (share[:, 0] if right else 1 - share[:, 0]) * (share[:, 1] if up else 1 - share[:, 1])
        found.append((pixel, row * 3 * texels + strip * texels + column, weight))
    return tuple(np.concatenate(part) for part in zip(*found, strict=True))  # type: ignore[return-value]


Value = TypeVar("Value")


def kept(store: OrderedDict[Hashable, Value], key: Hashable, most: int, make: Callable[[], Value]) -> Value:
    """What a store has under a key, made where it has none; of the latest asked for, `most` stay."""
    if key not in store:
        store[key] = make()
        while len(store) > most:
            store.popitem(last=False)
    store.move_to_end(key)
    return store[key]
