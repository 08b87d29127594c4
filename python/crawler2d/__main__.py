"""The programs of the package."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import NoReturn

from crawler2d.common.keywords import suggestion
from crawler2d.errors import Crawler2dError
from crawler2d.reports import atlas, audit, study
from crawler2d.reports.paper import chart
from crawler2d.reports.paper import command as paper

__all__ = ["main"]


class _Parser(argparse.ArgumentParser):
    """Says in one line what is wrong with the options, and which was probably meant."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message}; {self.prog} --help lists the options\n")

    def refuse(self, unknown: Sequence[str]) -> NoReturn:
        name = unknown[0].partition("=")[0]
        options = [each for action in self._actions for each in action.option_strings]
        self.error(f"{name} is not known{suggestion(name, options)}")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a program from the command line; returns its exit status."""
    parser = _Parser(prog="crawler2d", description=__doc__)
    programs = parser.add_subparsers(dest="program", required=True, metavar="program")
    named = {"study": study, "paper": paper, "paper-chart": chart, "audit": audit, "atlas": atlas}
    parsers = {}
    for name, module in named.items():
        text = (module.__doc__ or name).partition("\n")[0].rstrip(".")
        parsers[name] = programs.add_parser(name, help=text, description=module.__doc__)
        module.add_arguments(parsers[name])
    options, unknown = parser.parse_known_args(arguments)
    if unknown:
        parsers[options.program].refuse(unknown)
    try:
        status: int = named[options.program].run(options)
    except Crawler2dError as error:
        print(f"{parser.prog} {options.program}: {error}", file=sys.stderr)  # noqa: T201
        return 2
    return status


if __name__ == "__main__":
    sys.exit(main())
