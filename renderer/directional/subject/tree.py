"""A tree of the species that forests are planted of."""

from __future__ import annotations

from typing import Literal

from renderer.core.params import Model, param
from renderer.directional.subject.solid import Solid
from renderer.world.species import species

HEIGHT, BROADER = 11.0, 2.0
"""A tree [m] that stands alone: lower than in a forest, its crown so many times as wide for its height."""


class Tree(Model):
    """A tree with trunk, branches and leaves."""

    kind: Literal["tree"] = "tree"
    size: float = param(2.0, label="Size", help="Of its longest side.", unit="m", cost="bake", gt=0, le=1000)
    species: Literal["birch", "broadleaf", "conifer"] = param(
        "broadleaf", label="Species", help="How it grows.", cost="bake"
    )
    seed: int = param(1, label="Seed", help="Another number grows another tree.", cost="bake", ge=0, le=1_000_000)

    def solid(self) -> Solid:
        """Its triangles, seen from both sides."""
        kind = species()[self.species]
        grown = kind.sample(self.seed, HEIGHT, kind.crown * BROADER * HEIGHT)
        return Solid(grown.vertices, grown.faces, grown.colour, two_sided=True)
