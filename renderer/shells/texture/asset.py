"""The user's own volume."""

from __future__ import annotations

from typing import Literal

import numpy as np

from renderer.core.cache import AssetStore
from renderer.core.errors import InputError
from renderer.core.params import param
from renderer.shells.texture.block import Matter
from renderer.shells.texture.source import Source, slope_of, unit, with_glow
from renderer.world.volume import VolumeReading, load_volume

ASSET = r"^asset:[0-9a-f]{64}$"


class UserVolume(Source):
    """An uploaded volume."""

    kind: Literal["asset"] = "asset"
    asset: str = param(
        ..., label="File", help="An uploaded volume, as asset:HASH.", cost="bake", pattern=ASSET, takes=("volume",)
    )
    reading: VolumeReading = param(VolumeReading(), label="Reading", help="What the file leaves unsaid.", cost="bake")

    def matter(self) -> Matter:
        """The file's voxels as they are, with normals against the gradient of their extinction."""
        try:
            path = AssetStore().get(self.asset.removeprefix("asset:")).path
            volume = load_volume(path, reading=self.reading)
        except InputError as failure:
            own = failure.field in VolumeReading.model_fields
            raise failure.at(f"texture.reading.{failure.field}" if own else "texture.asset") from None
        colour = np.concatenate([volume.colour(), volume.rgba[..., 3:]], axis=-1)
        # Per voxel along each axis, then per length: voxels need not be cubes.
        voxel = np.array(volume.size) / volume.rgba.shape[2::-1]
        normal = unit((-slope_of(volume.extinction()) / voxel).astype(np.float32))
        there = (colour[..., 3] > 0).astype(np.uint8)
        return Matter(colour, with_glow(normal * there[..., None]), there,
                      reference_length=volume.reference_length, size=volume.size, notes=volume.notes)
