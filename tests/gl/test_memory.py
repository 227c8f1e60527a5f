"""Nothing writes beside its memory: drawing, replacing and reading under an allocator that checks every block."""

from __future__ import annotations

import ctypes
import signal
import subprocess

import pytest

from tests.gl.test_context import run_alone

CHECKER = "libc_malloc_debug.so.0"
"""glibc's checking allocator, which is a library of its own since 2.34."""

DRAWINGS = """
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from renderer.gl.resident import Resident
from renderer.gl.source import assemble
from renderer.gl.targets import Target, run_fullscreen
from renderer.gl.thread import GLThread
from server.encode import encode

BODY = '''
out vec4 colour;
uniform sampler2D flat_one;
uniform sampler3D deep;
uniform vec4 tint[5];
void main() {
    colour = tint[int(gl_FragCoord.x) % 5] * textureLod(flat_one, gl_FragCoord.xy / 64.0, 0.0);
    for (int i = 0; i < 16; i++) colour += 0.01 * textureLod(deep, vec3(gl_FragCoord.xy / 64.0, 0.1 * float(i)), 1.0);
}
'''
rng = np.random.default_rng(1)


def volume(gl, side):
    levels = [rng.integers(0, 255, (side >> n,) * 3 + (3,), np.uint8) for n in range(3)]
    return gl.texture3d(levels[0], mips=levels[1:])


def frame(gl, number, held, target):
    side = (12, 20, 36)[number % 3]
    kept = held.get(number // 2, lambda: {
        "flat_one": gl.texture2d(rng.random((side, side - 1, 3)).astype(np.float32)), "deep": volume(gl, side)})
    target.resize(*((37, 53), (64, 64), (91, 33))[number % 3])
    target.use()
    run_fullscreen(gl, assemble([], body=BODY), kept, {"tint": rng.random((5 + number % 2, 4))})
    return (255 * np.clip(target.read()[..., :3], 0, 1)).astype(np.uint8)


with GLThread() as thread, ThreadPoolExecutor(3) as pool:
    made = thread.call(lambda gl: (Resident(gl, 4), Target(gl, 8, 8)))
    thread.call(lambda gl: gl.at_close(made[1]))
    jobs = [pool.submit(encode, thread.call(frame, number, *made), ("jpeg", "png")[number % 2], 80)
            for number in range(300)]
    assert all(job.result()[0] for job in jobs)
"""
BESIDE = """
import ctypes
import gc

blocks = [np.zeros(5000, np.uint8) for _ in range(100)]
for block in blocks:
    ctypes.memset(block.ctypes.data, 1, 5004)
del block, blocks
gc.collect()
"""


def under_the_checker(code: str) -> subprocess.CompletedProcess[str]:
    """Every block checked when it is freed, and filled with bytes that no pointer survives."""
    return run_alone(code, LD_PRELOAD=CHECKER, MALLOC_CHECK_="3", MALLOC_PERTURB_="165", PYTHONMALLOC="malloc")


@pytest.fixture(scope="module", autouse=True)
def _checker() -> None:
    try:
        ctypes.CDLL(CHECKER)
    except OSError:
        pytest.skip(f"this machine has no {CHECKER}")


def test_replacing_what_is_drawn_with_writes_nowhere_else() -> None:
    done = under_the_checker(DRAWINGS)
    assert done.returncode == 0, done.stderr


def test_a_write_beside_a_block_is_found() -> None:
    assert under_the_checker("import numpy as np" + BESIDE).returncode == -signal.SIGABRT
