#!/bin/sh
# Sets up a checkout: a virtual environment with the locked dependencies, and a usable OpenGL.
#
#   docker/setup.sh run     what the viewer needs
#   docker/setup.sh test    that, the test tools, and a Chromium
#
# The Makefile and the Dockerfile both call it, so that what one proves holds for the other. Where a system package is
# missing on Debian or Ubuntu it is installed (as root, or through sudo); otherwise the one command to type is printed.
# A second call finds everything in place and takes under a second.
set -eu
cd "$(dirname "$0")/.."
what=${1:-run}
venv=.venv

say() { printf '%s\n' "$*" >&2; }
fail() { say "" "$@"; exit 1; }

debian() { [ -r /etc/os-release ] && grep -qE '^(ID|ID_LIKE)=.*(debian|ubuntu)' /etc/os-release && command -v apt-get >/dev/null; }

# need WHY PACKAGE...: install system packages, or say how and stop.
need() {
    why=$1; shift
    debian || fail "$why." "On this system Umbrage cannot install that by itself. It needs, beside Python 3.11 or newer:" \
        "  - Python's venv module," "  - an EGL library with OpenGL 3.3 or newer (Mesa's software renderer will do)," \
        "  - for the tests, a Chromium." "Umbrage is developed and tested on Debian and Ubuntu. On macOS and Windows use the" \
        "container: docker compose -f docker/compose.yaml up"
    if [ "$(id -u)" = 0 ]; then
        root=""
    elif command -v sudo >/dev/null && { sudo -n true 2>/dev/null || [ -t 0 ]; }; then
        root=sudo
    else
        fail "$why. Type this once, as a user who may, and try again:" "" \
            "  sudo sh -c 'apt-get update && apt-get install -y --no-install-recommends $*'"
    fi
    say "$why: installing $*"
    $root apt-get update -q
    $root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "$@"
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

usable_venv() { "$venv/bin/python" -c 'import sys, pip; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; }

make_venv() {
    usable_venv && return
    find_python >/dev/null || need "Python 3.11 or newer is missing" python3 python3-venv
    python=$(find_python) || fail "This system's newest Python is older than 3.11." \
        "Install Python 3.11 or newer and name it: make run PYTHON=/path/to/python3.11"
    "$python" -c 'import ensurepip, venv' 2>/dev/null || need "Python's venv module is missing" python3-venv
    say "Making the virtual environment with $python"
    rm -rf "$venv"
    "$python" -m venv "$venv"
}

# install LOCK: the locked dependencies, each checked against its hash; skipped when this very lock is installed.
install() {
    lock=docker/$1
    stamp=$venv/umbrage-$1
    sums=$(cat "$lock" pyproject.toml | sha256sum)
    [ "$(cat "$stamp" 2>/dev/null || true)" = "$sums" ] && return
    say "Installing the locked dependencies ($lock)"
    "$venv/bin/pip" install --quiet --disable-pip-version-check --require-hashes --no-deps -r "$lock"
    "$venv/bin/pip" install --quiet --disable-pip-version-check --no-deps --no-build-isolation --no-index --editable .
    printf '%s\n' "$sums" > "$stamp"
}

# Prints what is wrong with OpenGL here; nothing when it is usable.
opengl_problem() {
    "$venv/bin/python" - 2>&1 <<'PYTHON' | tail -n 1
import moderngl
context = moderngl.create_context(standalone=True, backend="egl", require=330)
context.release()
PYTHON
}

check_opengl() {
    problem=$(opengl_problem)
    [ -z "$problem" ] && return
    need "No OpenGL 3.3 through EGL ($problem)" libegl1 libegl-mesa0 libgl1 libgl1-mesa-dri
    problem=$(opengl_problem)
    [ -z "$problem" ] || fail "OpenGL 3.3 through EGL is still not usable: $problem"
}

# The tests drive a real browser: the system's, or the one that playwright brings where Debian's package is none.
check_chromium() {
    for browser in chromium chromium-browser google-chrome; do
        command -v "$browser" >/dev/null && ! [ -d "/snap/$browser" ] && return
    done
    ls "${PLAYWRIGHT_BROWSERS_PATH:-$HOME/.cache/ms-playwright}"/chromium*/INSTALLATION_COMPLETE >/dev/null 2>&1 && return
    if debian && ! grep -q '^ID=ubuntu' /etc/os-release; then
        need "The tests need a Chromium" chromium
    else
        # Ubuntu's chromium is a snap, which a headless machine cannot run.
        say "The tests need a Chromium: installing playwright's"
        "$venv/bin/playwright" install --with-deps chromium || need "The tests need a Chromium" chromium
    fi
}

case $what in
    run | test) ;;
    *) fail "usage: docker/setup.sh [run|test]" ;;
esac
make_venv
if [ "$what" = test ]; then
    install requirements-test.lock
    check_chromium
else
    install requirements.lock
fi
check_opengl
