"""The command line, `umbrage`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from renderer.core.errors import InputError, InvalidDocument, UmbrageError
from server import (
    cli_asset,
    cli_climb,
    cli_distance,
    cli_draw,
    cli_far,
    cli_headline,
    cli_keyframes,
    cli_leaves,
    cli_measure,
    cli_orders,
    cli_serve,
    cli_stability,
    cli_study,
    cli_sunlight,
)

FAILED, REFUSED, INTERRUPTED = 1, 2, 130
"""Exit codes: something of ours or of the machine, something that was asked wrongly, Ctrl-C."""


def parser(arguments: Sequence[str]) -> argparse.ArgumentParser:
    """The parser of every command; for a quick start, two declare their many options only where they are asked for."""
    top = argparse.ArgumentParser(
        prog="umbrage", description="Relights natural scenes in real time, and says how right each picture is."
    )
    commands = top.add_subparsers(dest="command", required=True, metavar="COMMAND")
    cli_serve.add(commands)
    cli_draw.add(commands)
    cli_asset.add(commands)
    cli_climb.add(commands)
    cli_distance.add(commands)
    cli_far.add(commands)
    cli_headline.add(commands)
    cli_measure.add(commands, "measure" in arguments)
    cli_orders.add(commands)
    cli_keyframes.add(commands)
    cli_sunlight.add(commands, "sunstudy" in arguments)
    cli_study.add(commands)
    cli_stability.add(commands)
    cli_leaves.add(commands)
    return top


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; errors are sentences on stderr.

    Returns:
        the exit code.
    """
    words = sys.argv[1:] if arguments is None else list(arguments)
    given = parser(words).parse_args(words)
    try:
        code: int = given.run(given)
    except InvalidDocument as failure:
        for error in failure.errors:
            print(f"umbrage: {error}", file=sys.stderr)
        return REFUSED
    except InputError as failure:
        print(f"umbrage: {failure}", file=sys.stderr)
        return REFUSED
    except UmbrageError as failure:
        print(f"umbrage: {failure}", file=sys.stderr)
        return FAILED
    except OSError as failure:
        print(f"umbrage: {failure.filename or 'system'}: {failure.strerror or failure}", file=sys.stderr)
        return FAILED
    except KeyboardInterrupt:
        print("umbrage: interrupted", file=sys.stderr)
        return INTERRUPTED
    return code


if __name__ == "__main__":
    sys.exit(main())
