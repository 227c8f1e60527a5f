"""Evaluates GLSL functions over arrays, so that a test can hold them against their numpy twins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from typing import Any

import moderngl
import numpy as np

from renderer.core.errors import UmbrageError
from renderer.gl.context import GL
from renderer.gl.program import AnyTexture, bind_textures, declared, set_uniforms
from renderer.gl.source import DefineValue, assemble
from renderer.gl.textures import sampler_type

_WIDTH = 1024  # texels a row of the inputs and outputs; with 16384 rows, the least any driver here allows, 16 M values
_VECTORS = {"f": ("float", "vec2", "vec3", "vec4"), "i": ("int", "ivec2", "ivec3", "ivec4"),
            "u": ("uint", "uvec2", "uvec3", "uvec4")}
_DTYPES = {"f4": np.float32, "i4": np.int32, "u4": np.uint32}


def probe(
    gl: GL,
    files: Sequence[str],
    body: str,
    inputs: Mapping[str, np.ndarray],
    outputs: int = 1,
    *,
    dtype: str = "f4",
    uniforms: Mapping[str, Any] | None = None,
    textures: Mapping[str, AnyTexture] | None = None,
    declarations: str = "",
    defines: Mapping[str, DefineValue] | None = None,
    version: tuple[int, int] = (3, 3),
) -> np.ndarray:
    """Evaluate GLSL for N inputs, in float32.

    Args:
        files: shader files with the functions under test, relative to the shader root.
        body: an expression, as `sky_radiance(direction)`; or statements, with a semicolon, that assign `result`.
        inputs: values by the name they have in `body`, (N,) or (N, k) with k up to 4: float becomes float or a vector
            of float32, integers become int, or uint where the array is unsigned, of 32 bits.
        outputs: components k of `result`: float, vec2, vec3, vec4; above 4 it is `float result[k]`, up to 32.
        dtype: type of `result`: "f4", "i4" or "u4".
        uniforms, textures: values by name. Those that `declarations` does not declare are declared by their type here.
        declarations: GLSL declarations of uniforms that the files rely on.
        defines: macros by name.
        version: OpenGL version the files require.

    Returns:
        (N, outputs) of the output type.

    Raises:
        ShaderError: the composed shader does not compile.
        UmbrageError: inputs of unequal length or unusable type, or a uniform of which the type cannot be told.
    """
    uniforms, textures = dict(uniforms or {}), dict(textures or {})
    columns = {name: _column(name, values) for name, values in inputs.items()}
    counts = {len(column) for column in columns.values()}
    if len(counts) != 1 or 0 in counts:
        raise UmbrageError("a probe takes at least one input, and inputs of one and the same length, at least 1")
    count = counts.pop()
    known = declared(declarations)
    text = [declarations]
    text += [f"uniform {sampler_type(texture)} {name};" for name, texture in textures.items() if name not in known]
    text += [f"uniform {_uniform_type(name, value)} {name};" for name, value in uniforms.items() if name not in known]
    vertex = assemble(["stages/fullscreen.vert"], version=version)
    fragment = assemble([*files], version=version, defines=defines, declarations="\n".join(text),
                        body=_body(columns, body, outputs, dtype[0]))
    program = gl.programs.get(vertex, fragment)
    with ExitStack() as made:
        packed = {}
        for name, column in columns.items():
            packed[f"probe_in_{name}"] = _packed(gl, column)
            made.callback(packed[f"probe_in_{name}"].release)
        set_uniforms(program, uniforms)
        bind_textures(program, {**textures, **packed})
        return _run(gl, program, count, outputs, dtype, made)


def _run(gl: GL, program: moderngl.Program, count: int, outputs: int, dtype: str, made: ExitStack) -> np.ndarray:
    """Draw into as many targets as the outputs take and gather their columns."""
    rows = -(-count // _WIDTH)
    targets = []
    for _ in range(-(-outputs // 4)):
        targets.append(gl.ctx.texture((_WIDTH, rows), 4, dtype=dtype))
        made.callback(targets[-1].release)
    framebuffer = gl.ctx.framebuffer(targets)
    made.callback(framebuffer.release)
    framebuffer.use()
    gl.ctx.disable(moderngl.BLEND | moderngl.DEPTH_TEST)
    gl.programs.draw(program)
    read = []
    for index in range(len(targets)):
        values = np.empty((rows * _WIDTH, 4), _DTYPES[dtype])
        framebuffer.read_into(values, components=4, attachment=index, alignment=1, dtype=dtype)
        read.append(values[:count])
    return np.ascontiguousarray(np.concatenate(read, axis=1)[:, :outputs])


def _column(name: str, values: np.ndarray) -> np.ndarray:
    """An input as (N, k) of a 32-bit type."""
    array = np.asarray(values)
    kinds = {"f": np.float32, "i": np.int32, "u": np.uint32, "b": np.int32}
    if array.dtype.kind not in kinds:
        raise UmbrageError(f"probe input {name} has no GLSL type: {array.dtype}")
    shaped = array[:, None] if array.ndim == 1 else array
    if shaped.ndim != 2 or not 1 <= shaped.shape[1] <= 4:
        raise UmbrageError(f"probe input {name} is {array.shape}, not (N,) or (N, k) with k up to 4")
    return np.ascontiguousarray(shaped, dtype=kinds[array.dtype.kind])


def _packed(gl: GL, column: np.ndarray) -> moderngl.Texture:
    rows = -(-len(column) // _WIDTH)
    texels = np.zeros((rows * _WIDTH, 4), column.dtype)
    texels[:len(column), :column.shape[1]] = column
    return gl.texture2d(texels.reshape(rows, _WIDTH, 4), filter="nearest")


def _body(columns: Mapping[str, np.ndarray], body: str, outputs: int, kind: str) -> str:
    """The generated `main`: fetch every input, evaluate, hand the result out."""
    if not 1 <= outputs <= 32 or kind not in _VECTORS:
        raise UmbrageError("a probe gives 1 to 32 components of type f4, i4 or u4")
    scalar, vector = _VECTORS[kind][0], _VECTORS[kind][3]
    lines = []
    for name, column in columns.items():
        prefix = "" if column.dtype.kind == "f" else column.dtype.kind
        lines.append(f"uniform {prefix}sampler2D probe_in_{name};")
    slots = -(-outputs // 4)
    lines += [f"layout(location = {slot}) out {vector} probe_out_{slot};" for slot in range(slots)]
    lines += ["void main() {", "ivec2 probe_texel = ivec2(gl_FragCoord.xy);"]
    for name, column in columns.items():
        k = column.shape[1]
        kind_in, swizzle = _VECTORS[column.dtype.kind][k - 1], "xyzw"[:k]
        lines.append(f"{kind_in} {name} = texelFetch(probe_in_{name}, probe_texel, 0).{swizzle};")
    lines.append(f"{scalar} result[{outputs}];" if outputs > 4 else f"{_VECTORS[kind][outputs - 1]} result;")
    lines.append(body if ";" in body else f"result = {body};")
    for slot in range(slots):
        parts = ([f"result[{i}]" for i in range(slot * 4, min(outputs, slot * 4 + 4))] if outputs > 4 else ["result"])
        missing = 4 * (slot + 1) - outputs if slot == slots - 1 else 0
        lines.append(f"probe_out_{slot} = {vector}({', '.join(parts + [f'{scalar}(0)'] * missing)});")
    return "\n".join([*lines, "}"])


def _uniform_type(name: str, value: Any) -> str:
    array = np.asarray(value)
    kind = array.dtype.kind
    if array.ndim == 0 and kind == "b":
        return "bool"
    if kind in "fiu" and array.ndim <= 1 and (array.ndim == 0 or 2 <= array.size <= 4):
        return _VECTORS[kind][array.size - 1]
    raise UmbrageError(f"declare the probe's uniform {name}: its type does not follow from {array.dtype} {array.shape}")
