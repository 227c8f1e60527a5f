"""Composition as text, without a GPU: includes once, origins true, rules enforced."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from renderer.core.errors import ShaderError, UmbrageError
from renderer.core.registry import SHADERS
from renderer.gl.source import assemble, without_comments


def write(root: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text, encoding="utf-8")
    return root


def test_parts_stand_in_their_order_and_every_line_knows_its_origin(tmp_path: Path) -> None:
    root = write(tmp_path, {"a.glsl": '// a\n#include "lib/b.glsl"\nfloat a() { return b(); }\n',
                            "lib/b.glsl": "float b() { return 1.0; }\n"})
    source = assemble(["a.glsl"], version=(4, 3), defines={"N": 3}, declarations="uniform float k;\nuniform int i;",
                      body="void main() {\n}", root=root)
    assert source.text.splitlines() == [
        "#version 430 core", "#define N 3", "uniform float k;", "uniform int i;", "// a",
        "// lib/b.glsl stands here, unless it came before", "float b() { return 1.0; }", "float a() { return b(); }",
        "void main() {", "}"]
    assert [source.locate(line) for line in range(1, 11)] == [
        ("<version>", 1), ("<defines>", 1), ("<declarations>", 1), ("<declarations>", 2), ("a.glsl", 1), ("a.glsl", 2),
        ("lib/b.glsl", 1), ("a.glsl", 3), ("<body>", 1), ("<body>", 2)]
    assert source.locate(0) == ("<version>", 1)
    assert source.locate(99) == ("<body>", 2)


def test_each_file_stands_once_however_often_it_is_asked_for(tmp_path: Path) -> None:
    root = write(tmp_path, {"lib/x.glsl": "float x;\n", "a.glsl": '#include "lib/x.glsl"\nfloat a;\n',
                            "b.glsl": '#include "lib/x.glsl"\n#include "a.glsl"\nfloat b;\n'})
    text = assemble(["a.glsl", "b.glsl", "lib/x.glsl", "a.glsl"], root=root).text
    assert [text.count(f"float {name};") for name in "xab"] == [1, 1, 1]
    assert text.index("float x;") < text.index("float a;") < text.index("float b;")


def test_a_cycle_is_named_whole(tmp_path: Path) -> None:
    root = write(tmp_path, {"a.glsl": '\n#include "b.glsl"\n', "b.glsl": '#include "c.glsl"\n',
                            "c.glsl": '// c\n\n#include "a.glsl"\n'})
    with pytest.raises(ShaderError) as caught:
        assemble(["a.glsl"], root=root)
    assert (caught.value.file, caught.value.line) == ("c.glsl", 3)
    assert "a.glsl -> b.glsl -> c.glsl -> a.glsl" in caught.value.message


def test_a_long_chain_of_includes_has_no_surprising_limit(tmp_path: Path) -> None:
    last = 250
    files = {f"f{i}.glsl": f'#include "f{i + 1}.glsl"\nfloat v{i};\n' for i in range(last)}
    source = assemble(["f0.glsl"], root=write(tmp_path, {**files, f"f{last}.glsl": "float end;\n"}))
    assert source.text.count("float v") == last
    assert source.locate(last + 2) == (f"f{last}.glsl", 1)


def test_defines_of_zero_false_and_nothing_are_defined(tmp_path: Path) -> None:
    source = assemble([], defines={"ZERO": 0, "EMPTY": "", "NO": False, "YES": True, "HALF": 0.5, "WHOLE": 2.0,
                                   "TINY": 1e-9, "WORD": "vec3"}, root=tmp_path)
    assert source.text.splitlines()[1:] == [
        "#define ZERO 0", "#define EMPTY", "#define NO 0", "#define YES 1", "#define HALF 0.5", "#define WHOLE 2.0",
        "#define TINY 1e-09", "#define WORD vec3"]


@pytest.mark.parametrize(("name", "value"), [("A", "1\nvoid main() {}"), ("A", "1 \\"), ("A B", 1), ("", 1), ("2A", 1),
                                             ("A(x)", "x"), ("A\n", 1), ("A", "1\r#version 110")])
def test_a_define_cannot_smuggle_in_lines(name: str, value: str | int) -> None:
    with pytest.raises(UmbrageError, match="define"):
        assemble([], defines={name: value})


@pytest.mark.parametrize(("text", "line", "words"), [
    ("float f;\nvoid main() {\n}\n", 2, "no main"),
    ("float f;\nvoid\tmain (\n) {}\n", 2, "no main"),
    ("\n\n# version 330\n", 3, "#version"),
    ("float f;\n\n  layout(binding = 1) uniform float k;\n", 3, "uniforms are generated"),
    ("/* uniform\n */ uniform int k;\n", 2, "uniforms are generated"),
])
def test_a_file_of_functions_keeps_to_functions(tmp_path: Path, text: str, line: int, words: str) -> None:
    with pytest.raises(ShaderError, match=words) as caught:
        assemble(["lib/bad.glsl"], root=write(tmp_path, {"lib/bad.glsl": text}))
    assert (caught.value.file, caught.value.line) == ("lib/bad.glsl", line)


def test_comments_may_speak_of_what_is_forbidden(tmp_path: Path) -> None:
    text = '// void main() with a uniform\n/* #version 330\n#include "none.glsl"\nuniform */\n' \
           '//#include "none.glsl"\nfloat f;'
    source = assemble(["a.glsl"], root=write(tmp_path, {"a.glsl": text}))
    assert source.text.endswith("float f;\n")
    assert '#include "' not in source.text, "moderngl would look for it"


def test_an_entry_stage_may_have_main_and_uniforms_but_no_version(tmp_path: Path) -> None:
    root = write(tmp_path, {"stages/x.frag": "uniform float k;\nvoid main() {}\n", "stages/y.frag": "#version 330\n"})
    assert "void main() {}" in assemble(["stages/x.frag"], root=root).text
    with pytest.raises(ShaderError, match="#version"):
        assemble(["stages/y.frag"], root=root)


@pytest.mark.parametrize("wanted", ["none.glsl", "../secret.glsl", "/etc/hostname", "lib", "lib/../../secret.glsl"])
def test_only_files_of_the_shader_folder_are_read(tmp_path: Path, wanted: str) -> None:
    root = write(tmp_path / "shaders", {"a.glsl": f'// a\n#include "{wanted}"\n', "lib/x.glsl": ""})
    write(tmp_path, {"secret.glsl": "float secret;\n"})
    with pytest.raises(ShaderError, match="no file of the shader folder") as caught:
        assemble(["a.glsl"], root=root)
    assert (caught.value.file, caught.value.line) == ("a.glsl", 2)
    with pytest.raises(ShaderError, match="no such file"):
        assemble([wanted], root=root)


def test_an_include_under_a_condition_is_refused(tmp_path: Path) -> None:
    root = write(tmp_path, {"x.glsl": "float x;\n", "a.glsl": '#if FOO\n#else\n#include "x.glsl"\n#endif\n',
                            "b.glsl": '#ifdef FOO\n#if BAR\n#endif\n#endif\n#include "x.glsl"\n'})
    with pytest.raises(ShaderError, match="condition") as caught:
        assemble(["a.glsl"], root=root)
    assert caught.value.line == 3
    assert "float x;" in assemble(["b.glsl"], root=root).text


@pytest.mark.parametrize("line", ["#include <x.glsl>", "#include x.glsl", '#include "x.glsl', "#include",
                                  '#include ""'])
def test_a_malformed_include_is_an_error_not_a_silence(tmp_path: Path, line: str) -> None:
    root = write(tmp_path, {"x.glsl": "float x;\n", "a.glsl": line + "\n"})
    with pytest.raises(ShaderError, match="an include reads"):
        assemble(["a.glsl"], root=root)


def test_an_include_may_be_followed_by_a_comment(tmp_path: Path) -> None:
    root = write(tmp_path, {"x.glsl": "float x;\n", "a.glsl": '  #  include "x.glsl"  // why\n'})
    assert "float x;" in assemble(["a.glsl"], root=root).text


def test_an_edited_file_is_read_anew(tmp_path: Path) -> None:
    root = write(tmp_path, {"a.glsl": "float old;\n"})
    assert "old" in assemble(["a.glsl"], root=root).text
    write(tmp_path, {"a.glsl": "float young;\n"})
    assert "young" in assemble(["a.glsl"], root=root).text


@given(st.lists(st.sampled_from(["a", " ", "\n", "//", "/*", "*/", "\\", "/", "*", '"']), max_size=40).map("".join))
def test_taking_comments_out_moves_no_line(text: str) -> None:
    clean = without_comments(text)
    assert clean.count("\n") == text.count("\n")
    assert "//" not in clean


def test_every_shader_file_of_the_checkout_can_be_composed() -> None:
    files = [str(path.relative_to(SHADERS)) for path in sorted(SHADERS.rglob("*.glsl"))]
    source = assemble(files)
    assert set(files) <= {file for file, _ in source.origin}
