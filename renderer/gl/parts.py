"""A picture drawn in parts, each over the pixels that have it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

import moderngl

from renderer.gl.context import GL
from renderer.gl.program import AnyTexture, bind_textures, set_uniforms
from renderer.gl.source import Source, stage

Where = tuple[Literal["<", ">", "==", "always"], float]
"""A test of a pixel's depth: how the number, in [0, 1], stands to it where the pixel is drawn."""

_DEPTH_FUNCTIONS = {"always": "1"}
"""Tests by moderngl's own name, where that is another."""


def run_parts(gl: GL, parts: Sequence[tuple[Source, Sequence[Where]]], depth: moderngl.Texture,
              textures: Mapping[str, AnyTexture], values: Mapping[str, Any]) -> None:
    """Run fragment stages over the bound framebuffer, each adding to what is there, and wait once for all.

    Args:
        parts: stages, and where they draw: where one of the tests holds of the depth.
        depth: of each pixel, a depth texture of the framebuffer's size.
        textures, values: as for `run_fullscreen`.
    """
    ctx = gl.ctx
    bound = ctx.fbo
    target = ctx.framebuffer(bound.color_attachments, depth)
    target.depth_mask = False
    try:
        target.use()
        ctx.enable(moderngl.DEPTH_TEST | moderngl.BLEND)
        ctx.blend_func = moderngl.ONE, moderngl.ONE
        for source, where in parts:
            program = gl.programs.get(stage("stages/at_depth.vert"), source)
            set_uniforms(program, values)
            bind_textures(program, textures)
            for test, place in where:
                ctx.depth_func = _DEPTH_FUNCTIONS.get(test, test)
                set_uniforms(program, {"stage_depth": place})
                gl.programs.draw(program, wait=False)
        gl.programs.wait()
    finally:
        ctx.disable(moderngl.DEPTH_TEST)
        ctx.depth_func = "<"
        bound.use()
        target.release()
