"""What drawing gives: a finished picture, or one frame of a view."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from renderer.world.image import save_image


@dataclass(frozen=True)
class Picture:
    """A finished picture.

    Attributes:
        linear: premultiplied linear radiance (height, width, 4) float32 [W m-2 sr-1], row 0 at the top.
        rgb8: as displayed, (height, width, 3) uint8.
        samples: a pixel.
        render_ms: time on the GL thread.
        meta: the document, the exposure (EV over 1 W m-2 sr-1) that displays it, and the renderer.
    """

    linear: np.ndarray
    rgb8: np.ndarray
    samples: int
    render_ms: float
    meta: dict[str, Any] = field(default_factory=dict)

    def encode(self, image_format: str) -> bytes:
        """The picture as a file: png and jpeg as displayed, exr and npy as linear radiance."""
        return save_image(image_format, self.linear if image_format in ("exr", "npy") else self.rgb8)


@dataclass(frozen=True)
class Frame:
    """One frame of a view; `rgb8` as in `Picture`.

    Attributes:
        samples, target_samples: how many are in it, and how many its quality asks for.
        converged: whether it has them all.
        technique: the chosen techniques, in words.
    """

    rgb8: np.ndarray
    width: int
    height: int
    samples: int
    target_samples: int
    converged: bool
    render_ms: float
    technique: str
