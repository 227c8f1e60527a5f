"""Programs compiled once, their errors told in the source's own file and line, and uploads that know what is used."""

from __future__ import annotations

import re
from collections import OrderedDict
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, cast

import moderngl
import numpy as np

from renderer.core.errors import ShaderError, UmbrageError
from renderer.gl.source import Source, without_comments

AnyTexture = moderngl.Texture | moderngl.Texture3D | moderngl.TextureArray | moderngl.TextureCube
Texts = tuple[str, str]
"""Of a program's two stages."""

_STAGE = re.compile(r"^(\w+)\n=+$", re.MULTILINE)
_MESSAGES = (
    re.compile(r"^\s*\d+:(?P<line>\d+)\(\d+\):\s*error:\s*(?P<words>.*)$"),          # Mesa: 0:12(3): error: words
    re.compile(r"^\s*\d+\((?P<line>\d+)\)\s*:\s*error\s*(?P<words>.*)$"),            # NVIDIA: 0(12) : error C1: words
    re.compile(r"^\s*ERROR:\s*\d+:(?P<line>\d+):\s*(?P<words>.*)$", re.IGNORECASE),  # Khronos's compiler, AMD, Apple
)
_DECLARED = re.compile(r"\buniform\s+(?:(?:highp|mediump|lowp)\s+)?\w+\s+([^;]+);")
_FLOAT, _INT, _UINT, _BOOL = "f4", "i4", "u4", "i4"
# OpenGL's names of the uniform types (registry values), to the type their bytes have. Others are samplers: an index.
_GL_TYPES = {0x1406: _FLOAT, 0x8B50: _FLOAT, 0x8B51: _FLOAT, 0x8B52: _FLOAT,     # float, vec2, vec3, vec4
             0x1404: _INT, 0x8B53: _INT, 0x8B54: _INT, 0x8B55: _INT,             # int, ivec2, ivec3, ivec4
             0x1405: _UINT, 0x8DC6: _UINT, 0x8DC7: _UINT, 0x8DC8: _UINT,         # uint, uvec2, uvec3, uvec4
             0x8B56: _BOOL, 0x8B57: _BOOL, 0x8B58: _BOOL, 0x8B59: _BOOL,         # bool, bvec2, bvec3, bvec4
             0x8B5A: _FLOAT, 0x8B5B: _FLOAT, 0x8B5C: _FLOAT,                     # mat2, mat3, mat4
             0x8B65: _FLOAT, 0x8B66: _FLOAT, 0x8B67: _FLOAT, 0x8B68: _FLOAT, 0x8B69: _FLOAT, 0x8B6A: _FLOAT}


class ProgramCache:
    """Programs by the text of their stages, with the vertex-less array that draws a full screen with each.

    At most `limit` programs are kept; the one longest unasked for is released first. Whoever draws asks `get` again
    each frame (a dictionary look-up) instead of holding a program.

    Where the CPU draws, `finish` is called after each drawing: the next command would wait for it all the same, and
    stop every other thread of Python meanwhile.
    """

    def __init__(self, ctx: moderngl.Context, finish: Callable[[], None] | None = None, limit: int = 128) -> None:
        self._ctx = ctx
        self._finish = finish
        self._limit = limit
        self._programs: OrderedDict[Texts, moderngl.Program] = OrderedDict()
        self._screens: dict[Texts, moderngl.VertexArray] = {}
        self._keys: dict[int, Texts] = {}

    def __len__(self) -> int:
        return len(self._programs)

    def get(self, vertex: Source, fragment: Source) -> moderngl.Program:
        """The program of two stages, compiled on first use.

        Raises:
            ShaderError: the compiler's first complaint, at its true file and line.
        """
        key = vertex.text, fragment.text
        if key in self._programs:
            self._programs.move_to_end(key)
            return self._programs[key]
        try:
            program = self._ctx.program(vertex_shader=vertex.text, fragment_shader=fragment.text)
        except moderngl.Error as failure:
            raise shader_error(str(failure), {"vertex_shader": vertex, "fragment_shader": fragment}) from None
        self._programs[key] = program
        self._keys[id(program)] = key
        while len(self._programs) > self._limit:
            self._release(next(iter(self._programs)))
        return program

    def draw(self, program: moderngl.Program, wait: bool = True) -> None:
        """Run a program of this cache once per pixel of the bound framebuffer (stages/fullscreen.vert).

        Args:
            wait: for the drawing, where the CPU draws; or the caller does by `wait()`, after several drawings.
        """
        key = self._keys[id(program)]
        if key not in self._screens:
            self._screens[key] = self._ctx.vertex_array(program, [])
        self._screens[key].render(mode=moderngl.TRIANGLES, vertices=3)
        if wait:
            self.wait()

    def wait(self) -> None:
        """Wait for what was drawn, where the CPU draws."""
        if self._finish is not None:
            self._finish()

    def release(self) -> None:
        """Free every program."""
        for key in list(self._programs):
            self._release(key)

    def _release(self, key: Texts) -> None:
        if key in self._screens:
            self._screens.pop(key).release()
        program = self._programs.pop(key)
        del self._keys[id(program)]
        program.release()


def shader_error(words: str, stages: Mapping[str, Source]) -> ShaderError:
    """The compiler's first error as file, line and message.

    Args:
        words: moderngl's text: a heading, the stage's name underlined, the driver's messages.
        stages: the sources by the names moderngl gives them. A complaint of the linker belongs to no line: `<link>`, 0.
    """
    headings = list(_STAGE.finditer(words))
    for index, heading in enumerate(headings):
        end = headings[index + 1].start() if index + 1 < len(headings) else len(words)
        source = stages.get(heading.group(1))
        for text in words[heading.end():end].splitlines():
            for form in _MESSAGES:
                if source is not None and (found := form.match(text)):
                    file, line = source.locate(int(found["line"]))
                    return ShaderError(file, line, found["words"].strip())
    tail = words[headings[-1].end():] if headings else words
    return ShaderError("<link>", 0, " ".join(tail.split()))


def declared(declarations: str) -> list[str]:
    """Names of the uniforms that a text declares, arrays without their brackets."""
    names = []
    for group in _DECLARED.findall(without_comments(declarations)):
        names += [name.split("[")[0].split("=")[0].strip() for name in group.split(",")]
    return names


def unused(program: moderngl.Program, names: Iterable[str]) -> list[str]:
    """Those of the declared uniforms that the program never uses (the compiler dropped them)."""
    return [name for name in names if name not in program]


def set_uniforms(program: moderngl.Program, values: Mapping[str, Any]) -> None:
    """Upload values by name, leaving out the uniforms that the compiler dropped as unused.

    Args:
        values: scalars, vectors, arrays (n, components), or matrices (rows, columns) as written on paper.

    Raises:
        UmbrageError: a value of the wrong size, naming the uniform.
    """
    # What the program has and what it holds already: a frame changes few of its uniforms.
    kept: _Kept = program.extra if isinstance(program.extra, _Kept) else _Kept.of(program)
    program.extra = kept
    for name, member in kept.members.items():
        if name not in values:
            continue
        value = values[name]
        plain = isinstance(value, (int, float, tuple))
        if plain and name in kept.given and kept.given[name] == value:
            continue
        data = _uniform_bytes(name, member, value)
        if kept.bytes.get(name) != data:
            member.write(data)
            kept.bytes[name] = data
        if plain:
            kept.given[name] = value
        else:
            kept.given.pop(name, None)


@dataclass(frozen=True)
class _Kept:
    """A program's uniforms by name, the bytes that they hold, and the plain values that these were made of."""

    members: dict[str, moderngl.Uniform]
    bytes: dict[str, bytes]
    given: dict[str, Any]

    @staticmethod
    def of(program: moderngl.Program) -> _Kept:
        found = {name: member for name in program if isinstance(member := program[name], moderngl.Uniform)}
        return _Kept(found, {}, {})


def _uniform_bytes(name: str, member: moderngl.Uniform, value: Any) -> bytes:
    facts = cast(Any, member)  # moderngl's stubs leave these out
    data = np.asarray(value, dtype=_GL_TYPES.get(facts.gl_type, _INT))
    rank = 2 if facts.matrix else int(member.dimension > 1)
    if data.ndim == rank + 1 and len(data) >= member.array_length:
        data = data[:member.array_length]  # compilers cut an array after the last element that is used
    expected = member.dimension * member.array_length
    if data.size != expected:
        raise UmbrageError(f"uniform {name} takes {expected} numbers, not {data.size}")
    if facts.matrix:
        data = np.swapaxes(data, -1, -2)  # OpenGL stores columns
    return np.ascontiguousarray(data).tobytes()


def bind_textures(program: moderngl.Program, textures: Mapping[str, AnyTexture], first_unit: int = 0) -> int:
    """Bind textures to the samplers of those names, leaving out samplers that the program does not use.

    Returns:
        The first texture unit that is still free.

    Raises:
        UmbrageError: more textures than the machine has units.
    """
    unit = first_unit
    for name, texture in textures.items():
        member = program.get(name, None)
        if isinstance(member, moderngl.Uniform):
            if unit == program.ctx.default_texture_unit:  # the last one, on which moderngl uploads
                raise UmbrageError(f"no texture unit is left for {name}: this machine has {unit}")
            texture.use(unit)
            member.value = unit
            unit += 1
    return unit
