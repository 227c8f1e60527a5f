"""Every source of 3D texture, and the bake that makes one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

from pydantic import Field, TypeAdapter

from renderer.core.params import bake_arguments
from renderer.core.technique import Arrays, Bake
from renderer.shells.texture.asset import UserVolume
from renderer.shells.texture.bark import Bark
from renderer.shells.texture.chain import Chain
from renderer.shells.texture.clouds import Clouds
from renderer.shells.texture.fur import Fur
from renderer.shells.texture.jelly import Jelly
from renderer.shells.texture.meshed import Meshed
from renderer.shells.texture.relief import Relief
from renderer.shells.texture.rocks import Rocks
from renderer.shells.texture.source import Source
from renderer.shells.texture.trees import Trees
from renderer.shells.texture.uniform import Uniform
from renderer.shells.texture.weave import Weave
from renderer.shells.texture.wood import Wood

Texture = Annotated[
    Fur | Clouds | Jelly | Uniform | Chain | Rocks | Weave | Relief | Trees | Bark | Wood | Meshed
    | UserVolume,
    Field(discriminator="kind"),
]

_ANY: TypeAdapter[Source] = TypeAdapter(Texture)


def texture_bake(texture: Source) -> Bake:
    """The precomputation of a source's block."""
    return Bake("texture", bake_texture, bake_arguments(texture), seconds=texture.seconds)


def bake_texture(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> Arrays:
    """A block of matter.

    Args:
        arguments: the document's `texture`, without what costs no bake.

    Returns:
        `colour`, `normal` (K, J, I, 4), `material` (K, J, I), `size` (3,), `reference_length` () [m] (0: one voxel of
        the shell's height), `notes`, and `birth`, `rank` (K, J, I) where there are strands: see `Matter`.
    """
    progress(0.1, "making the texture")
    return _ANY.validate_python(arguments).matter().arrays()


def moment_of(texture: Source) -> dict[str, float]:
    """What a source says of this moment: the keywords of `texture_of` and `opacity_at`."""
    named = {"growth": "growth", "density": "density", "second": "second_opacity"}
    return {word: getattr(texture, name) for word, name in named.items() if hasattr(texture, name)}
