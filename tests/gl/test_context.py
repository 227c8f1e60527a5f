"""Machines without a usable OpenGL are told what is missing; each is tried in a process of its own."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

WAIT = 30.0  # seconds after which a test is stuck, far above what any of these takes


def run_alone(code: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", code], env={**os.environ, **environment}, text=True, timeout=WAIT,
                          capture_output=True, cwd=Path(__file__).parent.parent.parent, check=False)


TRY = """
from renderer.core.errors import GLUnavailable
from renderer.gl.thread import GLThread
try:
    GLThread()
except GLUnavailable as error:
    print(error)
"""


def test_a_machine_without_egl_is_told_what_to_install() -> None:
    done = run_alone(TRY, GLCONTEXT_LINUX_LIBEGL="libEGL-is-not-here.so")
    assert done.returncode == 0, done.stderr
    assert "OpenGL is not installed" in done.stdout
    assert "apt-get install libegl1" in done.stdout


def test_a_machine_with_too_old_an_opengl_is_refused_in_words() -> None:
    done = run_alone(TRY, MESA_GL_VERSION_OVERRIDE="3.1")
    assert done.returncode == 0, done.stderr
    assert "no OpenGL 3.3 context" in done.stdout


def test_a_process_that_forgets_to_close_still_ends() -> None:
    done = run_alone("from renderer.gl.thread import GLThread\nprint(GLThread().info.version >= (3, 3))")
    assert (done.returncode, done.stdout.strip()) == (0, "True"), done.stderr
