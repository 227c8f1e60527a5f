"""GLSL text composed of files, with the true file and line of every line kept.

A `.glsl` file holds pure functions: no `main`, no `#version`, no `uniform`. Those are generated, or belong to the entry
shaders of `shaders/stages` (`.vert`, `.frag`). Drivers number lines in the text they are given, and Mesa ignores the
file number of `#line` directives, so the origin of each line is recorded here instead.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from renderer.core.errors import ShaderError, UmbrageError
from renderer.core.registry import SHADERS

DefineValue = str | int | float | bool
Line = tuple[str, str, int]
"""Text of a line, its file relative to the shader root (or `<part>` when generated), its number there from 1."""

_INCLUDE = re.compile(r'\s*#\s*include\b\s*(.*)')
_QUOTED = re.compile(r'"([^"\n]+)"\s*\Z')
_CONDITIONAL = re.compile(r"\s*#\s*(if|ifdef|ifndef|endif)\b")
_VERSION = re.compile(r"\s*#\s*version\b")
_MAIN = re.compile(r"\bvoid\s+main\s*\(")
_UNIFORM = re.compile(r"\buniform\b")
_COMMENT = re.compile(r"//(?:[^\n\\]|\\.)*|/\*.*?(?:\*/|\Z)", re.DOTALL)
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*\Z")


@dataclass(frozen=True)
class Source:
    """Text of one shader stage.

    Attributes:
        text: what the compiler is given.
        origin: file and line, counted from 1, that each line of `text` came from.
    """

    text: str
    origin: tuple[tuple[str, int], ...]

    def locate(self, line: int) -> tuple[str, int]:
        """File and line behind line `line` of the text, counted from 1 as compilers do; beyond an end, the last."""
        return self.origin[min(max(line, 1), len(self.origin)) - 1]


def assemble(
    files: Sequence[str],
    *,
    version: tuple[int, int] = (3, 3),
    defines: Mapping[str, DefineValue] | None = None,
    declarations: str = "",
    body: str = "",
    root: Path = SHADERS,
) -> Source:
    """Compose one shader stage: version, defines, declarations, files with their includes (each file once), body.

    Args:
        files: paths relative to `root`, in order; `#include "lib/x.glsl"` lines in them are relative to `root` too.
        version: OpenGL version, as (3, 3); its GLSL version follows from it.
        defines: macros by name; 0, False and the empty text are defined too.
        declarations: generated declarations (uniforms, samplers) that the files rely on.
        body: generated text after the files, such as the `main` that calls their functions.
        root: the shader folder.

    Raises:
        ShaderError: a missing file, a cycle of includes, or a file of functions that declares what is generated.
        UmbrageError: a define that is no single-line macro.
    """
    lines: list[Line] = [(f"#version {version[0]}{version[1]}0 core", "<version>", 1)]
    lines += [(_define(name, value), "<defines>", number)
              for number, (name, value) in enumerate((defines or {}).items(), start=1)]
    lines += _generated("<declarations>", declarations)
    done: set[str] = set()
    for file in files:
        lines += _expand(root, file, done, ())
    lines += _generated("<body>", body)
    return Source("\n".join(text for text, _, _ in lines) + "\n", tuple((file, number) for _, file, number in lines))


@functools.cache
def stage(file: str, declarations: str = "") -> Source:
    """The stage of a file that stands alone but for its declarations, assembled once."""
    return assemble([file], declarations=declarations)


def without_comments(text: str) -> str:
    """The text with every comment blanked, its lines still where they were."""
    return _COMMENT.sub(lambda match: "\n" * match.group().count("\n") or " ", text)


def _lines(text: str) -> list[str]:
    """Lines as a GLSL compiler counts them; `str.splitlines` would also cut at form feeds and exotic separators."""
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    return lines if lines[-1] else lines[:-1]


def _define(name: str, value: DefineValue) -> str:
    if not _NAME.match(name):
        raise UmbrageError(f"{name!r} is no name for a shader define")
    text = str(int(value)) if isinstance(value, bool) else repr(value) if isinstance(value, float) else str(value)
    if {"\n", "\r", "\\"} & set(text):
        raise UmbrageError(f"the shader define {name} must be one line")
    return f"#define {name} {text}".rstrip()


def _generated(part: str, text: str) -> list[Line]:
    return [(line, part, number) for number, line in enumerate(_lines(text), start=1)]


def _expand(root: Path, file: str, done: set[str], trail: tuple[str, ...]) -> Iterator[Line]:
    """Lines of `file` with its includes in place, unless it was given before."""
    if file in done:
        return
    done.add(file)
    raw, clean = _read(root, file)
    depth = 0
    for number, (line, code) in enumerate(zip(raw, clean, strict=True), start=1):
        if conditional := _CONDITIONAL.match(code):
            depth += -1 if conditional.group(1) == "endif" else 1
        include = _INCLUDE.match(code)
        if include is None:
            # moderngl would resolve an #include that stands in a comment.
            yield line.replace("#include", "# include"), file, number
            continue
        wanted = _included(file, number, line, depth)
        if wanted in (*trail, file):
            raise ShaderError(file, number, "includes itself: " + " -> ".join((*trail, file, wanted)))
        if not _inside(root, wanted):
            raise ShaderError(file, number, f'includes "{wanted}", which is no file of the shader folder')
        yield f"// {wanted} stands here, unless it came before", file, number
        yield from _expand(root, wanted, done, (*trail, file))


def _included(file: str, number: int, line: str, depth: int) -> str:
    include = _INCLUDE.match(line)
    quoted = _QUOTED.match(include.group(1).split("//")[0].rstrip() if include else "")
    if quoted is None:
        raise ShaderError(file, number, 'an include reads #include "lib/name.glsl"')
    if depth:
        # Each file is given once: one left out by a condition would be missing wherever else it is included.
        raise ShaderError(file, number, "an include may not depend on a preprocessor condition")
    return quoted.group(1)


def _inside(root: Path, file: str) -> bool:
    path = (root / file).resolve()
    return path.is_relative_to(root.resolve()) and path.is_file()


def _read(root: Path, file: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    if not _inside(root, file):
        raise ShaderError(file, 1, "there is no such file in the shader folder")
    path = root / file
    return _parsed(path, file, path.stat().st_mtime_ns)


@functools.lru_cache(maxsize=512)
def _parsed(path: Path, file: str, changed: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Lines of a file, as written and without comments, checked against the rules; `changed` makes an edit seen."""
    text = path.read_text(encoding="utf-8")
    raw, clean = _lines(text), _lines(without_comments(text))
    for number, code in enumerate(clean, start=1):
        if _VERSION.match(code):
            raise ShaderError(file, number, "the #version is generated, a file may not state it")
        if path.suffix == ".glsl" and _MAIN.search(code):
            raise ShaderError(file, number, "a file of functions has no main")
        if path.suffix == ".glsl" and _UNIFORM.search(code):
            raise ShaderError(file, number, "uniforms are generated, a file of functions declares none")
    return tuple(raw), tuple(clean)
