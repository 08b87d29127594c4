"""Print a script that completes commands, options and files in a shell.

For bash, put eval "$(crawler2d completion bash)" into ~/.bashrc.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

from crawler2d.common.extras import extra

__all__ = ["add_arguments", "run"]

_SHELLS = ("bash", "zsh", "tcsh")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``crawler2d completion``."""
    parser.add_argument("shell", choices=_SHELLS)


def run(options: argparse.Namespace) -> int:
    """Print the completion script of a shell; return the exit status."""
    shtab = extra("shtab", "cli")
    for action in _actions(options.parser):
        if action.type is Path:
            action.complete = shtab.FILE  # type: ignore[attr-defined] # read by shtab
    print(shtab.complete(options.parser, options.shell))
    return 0


def _actions(parser: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    """List the arguments of a command line and of its commands."""
    for action in parser._actions:
        yield action
        if isinstance(action, argparse._SubParsersAction):
            for each in action.choices.values():
                yield from _actions(each)
