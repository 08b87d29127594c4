"""The programs of the package."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from crawler2d.errors import Crawler2dError
from crawler2d.reports import atlas, audit, study
from crawler2d.reports.paper import command as paper

__all__ = ["main"]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a program from the command line; returns its exit status."""
    parser = argparse.ArgumentParser(prog="python -m crawler2d", description=__doc__)
    programs = parser.add_subparsers(dest="program", required=True, metavar="program")
    named = {"study": study, "paper": paper, "audit": audit, "atlas": atlas}
    for name, module in named.items():
        text = (module.__doc__ or name).partition("\n")[0].rstrip(".")
        own = programs.add_parser(name, help=text, description=module.__doc__)
        module.add_arguments(own)
    options = parser.parse_args(arguments)
    try:
        status: int = named[options.program].run(options)
    except Crawler2dError as error:
        print(f"{parser.prog} {options.program}: {error}", file=sys.stderr)  # noqa: T201
        return 2
    return status


if __name__ == "__main__":
    sys.exit(main())
