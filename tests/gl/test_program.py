"""Programs: compiled once, bounded, their errors at the true line, their uniforms told apart."""

from __future__ import annotations

from pathlib import Path

import moderngl
import numpy as np
import pytest

from renderer.core.errors import ShaderError, UmbrageError
from renderer.gl.context import GL
from renderer.gl.program import ProgramCache, bind_textures, declared, set_uniforms, shader_error, unused
from renderer.gl.source import Source, assemble
from renderer.gl.targets import Target
from renderer.gl.thread import GLThread

VERTEX = assemble(["stages/fullscreen.vert"])
OUT = "layout(location = 0) out vec4 shown;"


def fragment(expression: str, declarations: str = "") -> Source:
    return assemble([], declarations=f"{declarations}\n{OUT}", body=f"void main() {{ shown = {expression}; }}")


def broken(root: Path, text: str, include_at: int) -> Source:
    """A composed stage with `text` as the file lib/broken.glsl, included on the given line of its user."""
    for name, content in {"lib/broken.glsl": text, "lib/fine.glsl": "float fine() { return 1.0; }\n",
                          "user.glsl": "\n" * (include_at - 1) + '#include "lib/broken.glsl"\nfloat used;\n'}.items():
        (root / name).parent.mkdir(exist_ok=True, parents=True)
        (root / name).write_text(content, encoding="utf-8")
    return assemble(["lib/fine.glsl", "user.glsl"], root=root, declarations=f"uniform float k;\n{OUT}",
                    body="void main() { shown = vec4(k); }")


@pytest.mark.parametrize(("text", "line", "words"), [
    ("float a;\n\n// why\nfloat f() { return vec3(1.0); }\n", 4, "vec3"),
    ("/* a comment\nof three\nlines */\nfloat f() { return missing; }", 4, "missing"),
    ("float f() {\n    return 1.0\n}\n", 3, "syntax error"),
    ("#if 0\nnothing\n#endif\nfloat f() { return undefined_function(1.0); }\n", 4, "undefined_function"),
])
def test_an_error_in_an_included_file_is_told_at_its_own_line(thread: GLThread, tmp_path: Path, text: str, line: int,
                                                              words: str) -> None:
    for include_at in (1, 7):
        source = broken(tmp_path, text, include_at)
        with pytest.raises(ShaderError, match=words) as caught:
            thread.call(lambda gl, source=source: gl.programs.get(VERTEX, source))
        assert (caught.value.file, caught.value.line) == ("lib/broken.glsl", line)


def test_an_error_after_the_include_and_in_generated_text_is_told_there(thread: GLThread, tmp_path: Path) -> None:
    (tmp_path / "x.glsl").write_text("float x;\nfloat y;\n", encoding="utf-8")
    (tmp_path / "a.glsl").write_text('#include "x.glsl"\nfloat z = nowhere;\n', encoding="utf-8")
    for source, place in ((assemble(["a.glsl"], root=tmp_path, body="void main() {}"), ("a.glsl", 2)),
                          (assemble(["x.glsl"], root=tmp_path, body="\nvoid main() { q = 1; }"), ("<body>", 2)),
                          (assemble([], declarations="uniform vec7 k;", body="void main() {}"), ("<declarations>", 1))):
        with pytest.raises(ShaderError) as caught:
            thread.call(lambda gl, source=source: gl.programs.get(VERTEX, source))
        assert (caught.value.file, caught.value.line) == place


def test_an_error_of_the_vertex_stage_is_told_there(thread: GLThread) -> None:
    vertex = assemble([], body="\n\nvoid main() { gl_Position = 1; }")
    with pytest.raises(ShaderError) as caught:
        thread.call(lambda gl: gl.programs.get(vertex, fragment("vec4(1.0)")))
    assert (caught.value.file, caught.value.line) == ("<body>", 3)


def test_a_linker_error_says_so(thread: GLThread) -> None:
    source = assemble([], declarations=f"float promised();\n{OUT}", body="void main() { shown = vec4(promised()); }")
    with pytest.raises(ShaderError, match="promised") as caught:
        thread.call(lambda gl: gl.programs.get(VERTEX, source))
    assert (caught.value.file, caught.value.line) == ("<link>", 0)


@pytest.mark.parametrize("message", [
    "0:4(12): error: `x' undeclared",
    "0(4) : error C1503: undefined variable \"x\"",
    "ERROR: 0:4: 'x' : undeclared identifier",
])
def test_every_driver_s_way_of_naming_a_line_is_understood(message: str) -> None:
    stages = {"vertex_shader": Source("\n" * 9, tuple(("v.vert", n) for n in range(1, 10))),
              "fragment_shader": Source("\n" * 9, tuple(("a.glsl", 100 + n) for n in range(1, 10)))}
    words = "GLSL Compiler failed\n\nfragment_shader\n===============\n" \
            f"0:2(1): warning: unused\n{message}\n0:7(1): error: more\n"
    error = shader_error(words, stages)
    assert (error.file, error.line) == ("a.glsl", 104)
    assert "x" in error.message


def test_the_thread_and_the_cache_survive_a_broken_program(thread: GLThread) -> None:
    kept = thread.call(lambda gl: gl.programs.get(VERTEX, fragment("vec4(0.5)")))
    with pytest.raises(ShaderError):
        thread.call(lambda gl: gl.programs.get(VERTEX, fragment("broken")))
    assert thread.call(lambda gl: gl.programs.get(VERTEX, fragment("vec4(0.5)"))) is kept


def test_the_longest_unasked_program_goes_first_and_is_released(thread: GLThread) -> None:
    def job(gl: GL) -> None:
        cache = ProgramCache(gl.ctx, limit=2)
        before = gl.live_objects()
        a, b = (cache.get(VERTEX, fragment(f"vec4({n}.0)")) for n in (1, 2))
        target = Target(gl, 1, 1)
        target.use()
        cache.draw(b)
        assert cache.get(VERTEX, fragment("vec4(1.0)")) is a
        cache.get(VERTEX, fragment("vec4(3.0)"))  # b is the oldest now
        assert len(cache) == 2
        assert isinstance(b.mglo, moderngl.InvalidObject)
        assert cache.get(VERTEX, fragment("vec4(1.0)")) is a
        cache.draw(cache.get(VERTEX, fragment("vec4(2.0)")))
        assert target.read()[0, 0, 0] == 2.0
        target.release()
        cache.release()
        assert len(cache) == 0
        assert gl.live_objects() == before
    thread.call(job)


def test_uniforms_reach_the_shader_with_their_type(thread: GLThread) -> None:
    names = "uniform float f; uniform vec3 v; uniform int i; uniform uint u; uniform bool b; uniform mat3 m;" \
            "uniform mat2x3 n; uniform float a[4]; uniform vec2 w[2];"
    expression = "vec4(f + v.z + float(i) + float(u) + float(b), (m * vec3(1, 10, 100)).x, a[2] + w[1].y, n[1][2])"
    values = {"f": 0.5, "v": np.array([1.0, 2.0, 3.0]), "i": -7, "u": 4_000_000_000, "b": True,
              "m": [[1, 2, 3], [4, 5, 6], [7, 8, 9]], "n": np.arange(6.0).reshape(3, 2), "a": [1, 2, 3, 4],
              "w": np.array([[1, 2], [3, 4]])}

    def job(gl: GL) -> np.ndarray:
        target = Target(gl, 1, 1)
        program = gl.programs.get(VERTEX, fragment(expression, names))
        set_uniforms(program, values)
        target.use()
        gl.programs.draw(program)
        read = target.read()[0, 0]
        target.release()
        return read
    # Row 0 of the matrix times the column (1, 10, 100) is 321: matrices are given as written on paper.
    np.testing.assert_allclose(thread.call(job), [0.5 + 3 - 7 + 4e9 + 1, 321, 3 + 4, 5], rtol=1e-6)


def test_a_value_of_the_wrong_size_is_named(thread: GLThread) -> None:
    source = fragment("vec4(place, 1.0)", "uniform vec3 place;")
    for value in (1.0, (1.0, 2.0), np.zeros(4)):
        with pytest.raises(UmbrageError, match=r"uniform place takes 3 numbers"):
            thread.call(lambda gl, value=value: set_uniforms(gl.programs.get(VERTEX, source), {"place": value}))


def test_unused_uniforms_are_skipped_and_listed(thread: GLThread) -> None:
    text = "uniform float used; // uniform float commented;\nuniform vec3 idle, idler[3];\n" \
           "uniform highp sampler2D image;"
    source = fragment("vec4(used)", text)
    program = thread.call(lambda gl: gl.programs.get(VERTEX, source))
    assert declared(text) == ["used", "idle", "idler", "image"]
    assert unused(program, declared(text)) == ["idle", "idler", "image"]
    thread.call(lambda gl: set_uniforms(program, {"used": 1.0, "idle": (1, 2, 3), "unknown": 3}))


def test_textures_are_bound_to_their_samplers(thread: GLThread) -> None:
    names = "uniform sampler2D first; uniform sampler3D second; uniform sampler2D idle;"
    source = fragment("texelFetch(first, ivec2(0), 0) + 10.0 * texelFetch(second, ivec3(0), 0)", names)

    def job(gl: GL) -> tuple[np.ndarray, int]:
        ones = gl.texture2d(np.full((1, 1, 4), 1, np.float32))
        twos = gl.texture3d(np.full((1, 1, 1, 4), 2, np.float32))
        target = Target(gl, 1, 1)
        program = gl.programs.get(VERTEX, source)
        free = bind_textures(program, {"idle": twos, "second": twos, "first": ones})
        target.use()
        gl.programs.draw(program)
        read = target.read()[0, 0]
        for made in (ones, twos, target):
            made.release()
        return read, free
    read, free = thread.call(job)
    assert (read == 21).all()
    assert free == 2
