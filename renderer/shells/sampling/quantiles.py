"""Opacity by even steps, light at the middles of equal shares of it."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from renderer.core.params import param
from renderer.core.technique import Bake
from renderer.shells.technique import ShellsTechnique
from renderer.shells.texture.sources import texture_bake
from renderer.shells.texture.strides import strides_bake


class Quantiles(ShellsTechnique):
    """A ray is lit at a few places, each of which stands for an equal share of what is seen."""

    title: ClassVar[str] = "Quantiles"
    caption: ClassVar[str] = "Opacity from few bytes a voxel; light in the middle of equal shares of it."
    paper: ClassVar[str] = "Danskin & Hanrahan 1992, section 4"
    whole: ClassVar[bool] = True

    kind: Literal["quantiles"] = "quantiles"
    rate: float = param(1.4, label="Rate", help="Samples a voxel.", ge=0.05, le=64)
    jitter: float = param(
        1.0, label="Jitter", help="By how much of a step samples move between pictures.", unit="ratio", ge=0, le=1
    )
    places: int = param(
        4, label="Places", help="Of a ray that are lit, one of each share of what it sees.", cost="build", unit="count",
        ge=1, le=14,
    )  # fmt: skip
    most: int = param(
        24, label="Most samples", help="Of one segment.", cost="build", unit="count", ge=1, le=4096
    )

    first_rays: Literal[1, 2, 4] = param(
        2, label="First rays", help="Of two by two pixels in a picture's first sample, which is smoothed below 4.",
        cost="host", unit="count",
    )  # fmt: skip
    first_places: int = param(
        4, label="First places", help="Of such a ray that are lit.", cost="host", unit="count", ge=1, le=14
    )

    def first_sample(self) -> tuple[Quantiles, int]:
        """Fewer rays, of more places each: what is shown while a camera moves."""
        places = self.places if self.first_rays == 4 else self.first_places
        return self.model_copy(update={"places": places}), self.first_rays

    def bakes(self, state: Any) -> list[Bake]:
        """How far rays may go within each voxel's matter."""
        return [strides_bake(texture_bake(state.texture), state.voxels.wrap)]
