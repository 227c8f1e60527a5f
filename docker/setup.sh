#!/bin/sh
# Sets up a checkout: a virtual environment with the locked dependencies, and a usable OpenGL.
#
#   docker/setup.sh run     what the viewer needs
#   docker/setup.sh test    that, the test tools, and a Chromium
#
# The Makefile and the Dockerfile both call it, so that what one proves holds for the other. Where system packages are
# missing on Debian or Ubuntu they are installed (as root, or through sudo); otherwise the one command to type is
# printed. A second call finds everything in place and takes a second.
set -eu
cd "$(dirname "$0")/.."
what=${1:-run}
venv=.venv
mesa="libegl1 libegl-mesa0 libgl1 libgl1-mesa-dri"

say() { printf '%s\n' "$@" >&2; }
fail() { say "" "$@" ""; exit 1; }

release() { grep -qE "^(ID|ID_LIKE)=.*($1)" /etc/os-release 2>/dev/null; }
debian() { release 'debian|ubuntu' && command -v apt-get >/dev/null; }
library() { PATH="$PATH:/sbin:/usr/sbin" ldconfig -p 2>/dev/null | grep -q "$1"; }

# need WHY PACKAGE...: install system packages, or say how and stop.
need() {
    why=$1
    shift
    debian || fail "$why." "" "Umbrage sets itself up on Debian and Ubuntu only. On this system, install yourself:" \
        "  - Python 3.11 or newer with its venv module," \
        "  - EGL with OpenGL 3.3 or newer (Mesa's software renderer will do)," \
        "  - for the tests, Chromium," \
        "and try again; or use the container: docker compose -f docker/compose.yaml up"
    if [ "$(id -u)" = 0 ]; then
        root=""
    elif command -v sudo >/dev/null && { sudo -n true 2>/dev/null || [ -t 0 ]; }; then
        root=sudo
    else
        fail "$why. Type this once, as a user who may, and try again:" "" \
            "  sudo sh -c 'apt-get update && apt-get install -y --no-install-recommends $*'"
    fi
    say "$why: installing $*"
    $root apt-get update -qq
    $root env DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends "$@" >/dev/null
}

find_python() {
    for python in ${PYTHON:-} python3 python3.14 python3.13 python3.12 python3.11; do
        if "$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
            command -v "$python"
            return
        fi
    done
    return 1
}

# The tests drive a real browser. Ubuntu's chromium package is a snap, which a headless machine cannot run; there,
# playwright's own is taken.
has_chromium() {
    for browser in chromium chromium-browser google-chrome; do
        command -v "$browser" >/dev/null && ! [ -d "/snap/$browser" ] && return
    done
    ls "${PLAYWRIGHT_BROWSERS_PATH:-$HOME/.cache/ms-playwright}"/chromium*/INSTALLATION_COMPLETE >/dev/null 2>&1
}

# All that is missing at once, so that who has to ask for it asks once.
check_system() {
    missing=""
    python=$(find_python) && "$python" -c 'import ensurepip, venv' 2>/dev/null || missing="python3 python3-venv"
    { library libEGL.so.1 && library libGL.so.1; } || missing="$missing $mesa"
    [ "$what" = run ] || has_chromium || release ubuntu || missing="$missing chromium"
    # shellcheck disable=SC2086  # the names are words
    [ -z "$missing" ] || need "Umbrage misses something of the system (${missing# })" $missing
    find_python >/dev/null || fail "This system's newest Python is older than 3.11." \
        "Install Python 3.11 or newer and name it: make $what PYTHON=/path/to/python3.11"
}

make_venv() {
    "$venv/bin/python" -c 'import sys, pip; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && return
    say "Making the virtual environment with $(find_python)"
    rm -rf "$venv"
    "$(find_python)" -m venv "$venv"
}

# install LOCK: the locked dependencies, each checked against its hash; skipped when this very lock is installed.
install() {
    lock=docker/$1
    stamp=$venv/umbrage-$1
    sums=$(cat "$lock" pyproject.toml | sha256sum)
    [ "$(cat "$stamp" 2>/dev/null || true)" = "$sums" ] && return
    say "Installing the locked dependencies ($lock)"
    # Tests compile what they import, a part of it; a server may run as somebody who may not write here.
    compile=--compile
    [ "$what" = run ] || compile=--no-compile
    "$venv/bin/pip" install --quiet --disable-pip-version-check $compile --require-hashes --no-deps -r "$lock"
    "$venv/bin/pip" install --quiet --disable-pip-version-check --no-deps --no-build-isolation --no-index --editable .
    printf '%s\n' "$sums" >"$stamp"
}

# Prints what is wrong with OpenGL here; nothing when it is usable.
opengl_problem() {
    "$venv/bin/python" - 2>&1 <<'PYTHON' | tail -n 1
import moderngl
moderngl.create_context(standalone=True, backend="egl", require=330).release()
PYTHON
}

# The libraries may be there without a driver that works without a screen; Mesa's always does.
check_opengl() {
    problem=$(opengl_problem)
    [ -n "$problem" ] || return 0
    # shellcheck disable=SC2086
    need "No OpenGL 3.3 through EGL ($problem)" $mesa
    problem=$(opengl_problem)
    [ -z "$problem" ] || fail "OpenGL 3.3 through EGL is still not usable: $problem"
}

case $what in
    run) lock=requirements.lock ;;
    test) lock=requirements-test.lock ;;
    *) fail "usage: docker/setup.sh [run|test]" ;;
esac
check_system
make_venv
install $lock
check_opengl
if [ "$what" = test ] && ! has_chromium; then
    say "The tests need a Chromium: installing playwright's"
    "$venv/bin/playwright" install --with-deps chromium
fi
