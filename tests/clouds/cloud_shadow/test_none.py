"""No shadow: all of sun and sky, wherever the clouds stand."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.clouds.cloud_shadow.none import NoCloudShadow
from tests.clouds.cloud_shadow.shades import shade

Ask = Callable[..., np.ndarray]
EAST = np.array([-2000.0, 2000.0])


def test_sun_and_sky_are_whole(ask: Ask) -> None:
    for part, whole in (("direct", 1.0), ("diffuse", 0.0), ("sky", 1.0)):
        assert shade(ask, NoCloudShadow(), EAST, 40.0, part) == pytest.approx([whole, whole])


def test_a_shade_is_found(ask: Ask, spoil: Callable) -> None:
    with spoil(
        "clouds/cloud_shadow/none.glsl",
        "Shade(vec3(1.0), vec3(0.0), vec3(1.0))",
        "Shade(vec3(0.5), vec3(0.0), vec3(1.0))",
    ):
        assert abs(shade(ask, NoCloudShadow(), EAST, 40.0, "direct") - 1).min() > 0.4
