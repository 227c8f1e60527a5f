"""The overcast sky: light through a closed layer of cloud, of which the sun's place cannot be seen.

Radiance is the standard overcast sky of the CIE, three times as bright at the zenith as at the horizon (Moon and
Spencer 1942). How much light that is follows from the clear sky's under the same sun: clouds over all eight eighths of
the sky leave 1 - 0.75 of its global irradiance, all of it diffuse (Kasten and Czeplak 1980, eq. 2). Clouds are taken to
thin out every band alike, and to hide the sun's disc wholly.
"""

from __future__ import annotations

import numpy as np

from renderer.world.atmosphere import Floats
from renderer.world.sky_picture import VIEW_SHAPE, irradiance_weights, view_directions

LEFT = 0.25
"""Share of the clear sky's global irradiance under a closed cover: 1 - 0.75 (8/8)^3.4 (Kasten and Czeplak 1980)."""


def brightness() -> Floats:
    """Radiance at the elevations of the sky's picture, (rows,), over that at the zenith (Moon and Spencer 1942)."""
    found: Floats = (1.0 + 2.0 * np.sin(view_directions()[0])) / 3.0
    return found


def overcast(suns: Floats, sun_irradiance: Floats, sky_irradiance: Floats) -> Floats:
    """Radiance of the overcast sky under each sun, (E, elevations, azimuths, 3) in W m-2 sr-1, as in the sky's picture.

    Args:
        suns: elevations (E,) in radians. sun_irradiance, sky_irradiance: (E, 3) of the clear sky, W m-2, the sun's
            normal to its beam.
    """
    level = LEFT * (np.maximum(np.sin(suns), 0.0)[:, None] * sun_irradiance + sky_irradiance)
    # the irradiance of this picture under a zenith of radiance one, 7 pi / 9 but for the interpolation
    zenith = level / float(np.sum(brightness()[:, None] * irradiance_weights()))
    found: Floats = zenith[:, None, None, :] * np.broadcast_to(brightness()[:, None], VIEW_SHAPE)[..., None]
    return found
