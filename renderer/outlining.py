"""What a scene is built of, as lines over its picture."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from renderer.core.errors import InputError
from renderer.core.registry import phenomena, phenomenon
from renderer.core.technique import BakedArrays, Outline
from renderer.world.state import SceneState

if TYPE_CHECKING:
    from renderer.session import Session


Baked = Callable[[SceneState], Mapping[str, BakedArrays]]


def outline_of(session: Session, state: SceneState, arrays: Baked) -> Outline:
    """Vertices and lines of a state's scene; blocks while what it needs is baked.

    Args:
        arrays: gives what was baked for a state.

    Raises:
        InputError: the scene has no lines.
    """
    found = phenomenon(state.scene).outline
    if found is None:
        having = [name for name, other in phenomena().items() if other.outline is not None]
        raise InputError("scene", "has no lines to show", ", ".join(having))
    if not session.prepared(state):
        session.prepare(state).future.result()
    return found(state, {name: entry.arrays for name, entry in arrays(state).items()})
