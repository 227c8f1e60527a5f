"""Without self-shadow the horizon alone hides the light."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.self_shadow.none import NoShadow
from tests.directional.self_shadow.conftest import towards

FILE = "directional/self_shadow/none.glsl"


def test_all_above_the_horizon_is_lit(see: Callable, spoil: Callable) -> None:
    given = towards(200)
    nothing = np.zeros((200, 4), np.uint32)
    seen = see(NoShadow(), hemisphere_of(129), nothing, given)
    np.testing.assert_array_equal(seen, given[:, 2] >= 0)
    with spoil(FILE, "step(0.0,", "step(-0.2,"):
        assert (see(NoShadow(), hemisphere_of(129), nothing, given) != seen).any()
