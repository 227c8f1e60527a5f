"""What a phenomenon, a slot and a technique are."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar, Protocol

import numpy as np

from renderer.core.params import Model

Arrays = Mapping[str, np.ndarray]


class Technique(Model):
    """One published way to fill a slot.

    A subclass is one Python file, one GLSL file of pure functions and one test, all of the same stem.
    Its discriminator `kind` is that stem: `kind: Literal["ray_march"] = "ray_march"`.
    """

    title: ClassVar[str]
    caption: ClassVar[str]
    """One line: what it is."""
    paper: ClassVar[str]
    """Who published it: author, year, section."""
    requires: ClassVar[tuple[int, int]] = (3, 3)
    """Lowest OpenGL version."""
    textures: ClassVar[Mapping[str, str]] = {}
    """Samplers the GLSL reads, by name, with their GLSL type; declared for it as `<slot>_<name>`."""


@dataclass(frozen=True)
class Slot:
    """A place in a phenomenon that techniques fill.

    Attributes:
        name: as in the document, `shadow`.
        title, help: for people.
        contract: the GLSL signature each technique must define, with units.
        default: kind of the default technique.
    """

    name: str
    title: str
    help: str
    contract: str
    default: str


@dataclass(frozen=True)
class Bake:
    """A precomputation: a pure function of plain JSON arguments and of other bakes' arrays.

    Attributes:
        name: role of its result in the scene, as `pattern`.
        function: module-level function `(arguments, inputs, progress) -> Arrays`, picklable;
            `progress(fraction, words)` raises `Cancelled` when the work is no longer wanted.
        arguments: JSON values; with the function's name and version, the cache key.
        inputs: bakes whose arrays it needs.
        version: raised when the function's result changes.
        seconds: what it is expected to take on two cores, to announce the cost before it starts.
    """

    name: str
    function: Callable[[dict[str, Any], dict[str, Arrays], Callable[[float, str], None]], Arrays]
    arguments: dict[str, Any]
    inputs: tuple[Bake, ...] = ()
    version: int = 1
    seconds: float = 1.0


@dataclass(frozen=True)
class BakedArrays:
    """What a bake gave, with the key of its content: equal keys mean equal arrays."""

    key: str
    arrays: Arrays


@dataclass(frozen=True)
class Outline:
    """What a scene is built of, as lines to lay over its picture.

    Attributes:
        arrays: vertices, lines and triangles, by name. facts: counts and sizes, by name. words: what must be told.
    """

    arrays: Arrays
    facts: Mapping[str, int | float]
    words: tuple[str, ...] = ()


class SceneRenderer(Protocol):
    """Draws one phenomenon for every view; lives on the GL thread."""

    def prepare(
        self,
        state: Any,
        baked: Mapping[str, BakedArrays],
        size: tuple[int, int],
        offset: tuple[float, float],
        sample: int,
    ) -> Any:
        """Draw what one sample needs into targets of the renderer's own.

        Args:
            state, baked: the document and what it needed baked, by name.
            size: (width, height) in pixels.
            offset: of the sample inside its pixel, from the top-left corner.
            sample: its number, from which any jitter follows.

        Returns:
            What `draw` needs.
        """

    def draw(self, prepared: Any) -> None:
        """Draw a prepared sample as linear premultiplied radiance into the bound framebuffer, with one pass or by
        adding several; see `renderer.gl.targets.Accumulator.draw`."""

    def release(self) -> None:
        """Free every GL object."""


@dataclass(frozen=True)
class Phenomenon:
    """One of the four systems.

    Attributes:
        name: as in the document's `scene`. place: among the scenes; the page opens on the first.
        state: the pydantic model of its whole state document.
        presets: named patches of the default document, with a title each.
        coarse: `state -> state` that looks about the same and is baked in seconds: shown while the other is on its way.
        combinations: named patches of the slots alone, which leave view and world as they are.
        bakes: what a state needs precomputed, inputs first.
        open: makes its renderer on the GL thread.
        world: `(state, arrays of the bakes by name) -> plain arrays and numbers`: what is drawn, whatever the
            techniques, for a reference that shares no code with them.
        world_needs: names of the bakes that `world` reads.
        world_bakes: `state -> bakes that its world reads`, where techniques do not ask for all of them; else those of
            `bakes` that `world_needs` names.
        metered_light: `(state, arrays of the bakes by name) -> W m-2`: how much light there is, for the exposure.
        probe: `(state, arrays of the bakes by name, x, y, (width, height)) -> facts` about a point of the picture, as
            JSON values.
        outline: `(state, arrays of the bakes by name) -> Outline`, where the scene is built of something to be shown.
    """

    name: str
    title: str
    help: str
    slots: tuple[Slot, ...]
    state: type[Model]
    presets: Mapping[str, Preset]
    bakes: Callable[[Any], list[Bake]]
    open: Callable[[Any], SceneRenderer]
    world: Callable[[Any, Mapping[str, Arrays]], dict[str, Any]]
    world_needs: tuple[str, ...]
    metered_light: Callable[[Any, Mapping[str, Arrays]], float]
    probe: Callable[[Any, Mapping[str, Arrays], float, float, tuple[int, int]], dict[str, Any]]
    combinations: Mapping[str, Preset] = field(default_factory=dict)
    place: int = 0
    world_bakes: Callable[[Any], list[Bake]] | None = None
    coarse: Callable[[Any], Any] | None = None
    outline: Callable[[Any, Mapping[str, Arrays]], Outline] | None = None


@dataclass(frozen=True)
class Preset:
    """A named patch of the default document.

    Attributes:
        title, help: for people. patch: what differs.
        group: of presets made for one purpose, in words; whatever takes all presets leaves them out. Else empty.
    """

    title: str
    help: str
    patch: dict[str, Any] = field(default_factory=dict)
    group: str = ""
