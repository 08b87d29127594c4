"""The commands of the package: `crawler2d audit` and `crawler2d atlas`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple, NoReturn

from crawler2d.commands import atlas, audit
from crawler2d.common.keywords import suggestion
from crawler2d.errors import Crawler2dError

__all__ = ["Command", "main", "run_command"]

_MOVED = {
    "study": "python -m research seizure",
    "paper": "python -m research paper",
    "paper-chart": "python -m research chart",
}
"""Commands that need a clone of the project, by the names that they had in the package."""


class Command(NamedTuple):
    """A subcommand: what it says of itself, its options, and what it does with them."""

    text: str
    add_arguments: Callable[[argparse.ArgumentParser], None]
    run: Callable[[argparse.Namespace], int]


def run_command(
    prog: str, text: str, commands: Mapping[str, Command], given: Sequence[str] | None
) -> int:
    """Run the subcommand that is given on a command line; returns its exit status."""
    parser = _Parser(prog=prog, description=text)
    choices = parser.add_subparsers(dest="command", required=True, metavar="command")
    parsers = {}
    for name, each in commands.items():
        first = each.text.partition("\n")[0].rstrip(".")
        parsers[name] = choices.add_parser(name, help=first, description=each.text)
        each.add_arguments(parsers[name])
    options, unknown = parser.parse_known_args(given)
    if unknown:
        parsers[options.command].refuse(unknown)
    try:
        return commands[options.command].run(options)
    except Crawler2dError as error:
        print(f"{prog} {options.command}: {error}", file=sys.stderr)  # noqa: T201
        return 2


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command of the package; returns its exit status."""
    given = sys.argv[1:] if arguments is None else arguments
    if given and given[0] in _MOVED:
        now = _MOVED[given[0]]
        print(f"crawler2d {given[0]} is now `{now}`, in a clone of the project", file=sys.stderr)  # noqa: T201
        return 2
    named = {"audit": audit, "atlas": atlas}
    commands = {
        name: Command(module.__doc__ or name, module.add_arguments, module.run)
        for name, module in named.items()
    }
    return run_command("crawler2d", __doc__, commands, given)


class _Parser(argparse.ArgumentParser):
    """Says in one line what is wrong with the options, and which was probably meant."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message}; {self.prog} --help lists the options\n")

    def refuse(self, unknown: Sequence[str]) -> NoReturn:
        name = unknown[0].partition("=")[0]
        options = [each for action in self._actions for each in action.option_strings]
        self.error(f"{name} is not known{suggestion(name, options)}")


if __name__ == "__main__":
    sys.exit(main())
