"""Simulate tracked robots in side view, and find which track models seize on an obstacle.

crawler2d COMMAND --help lists the options of a command.
"""

from __future__ import annotations

import argparse
import io
import os
import signal
import sys
import textwrap
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib import import_module
from typing import Any, NamedTuple, NoReturn

from crawler2d._core import build_info
from crawler2d.common import ctrl_c
from crawler2d.common.keywords import suggestion
from crawler2d.errors import Crawler2dError, ScenarioWarning

__all__ = ["Command", "main", "run_command"]

_COMMANDS = ("demo", "run", "view", "audit", "atlas", "schema", "info", "completion")

_SIGPIPE = 13
"""Missing on some systems."""

_MOVED = {
    "study": "python -m research seizure",
    "paper": "python -m research paper",
    "paper-chart": "python -m research chart",
}
"""Commands that moved to a clone of the project, by their former names in the package."""


class Command(NamedTuple):
    """A subcommand: its summary, its options, and the function that runs it.

    The parsed options include `parser`, the one for the whole command line.
    """

    text: str
    add_arguments: Callable[[argparse.ArgumentParser], None]
    run: Callable[[argparse.Namespace], int]


def run_command(
    prog: str,
    text: str,
    commands: Mapping[str, Command],
    given: Sequence[str] | None,
    *,
    version: str | None = None,
) -> int:
    """Run the subcommand of a command line; return its exit status.

    Parameters
    ----------
    prog, text : str
        Name and description of the program.
    commands : mapping of str to Command
        Subcommands by name.
    given : sequence of str, optional
        Command line; None takes that of the process.
    version : str, optional
        Text that ``--version`` prints; None for no such option.

    Notes
    -----
    Errors and Ctrl-C end with one line; the notes of a KeyboardInterrupt say what is kept.
    """
    given = sys.argv[1:] if given is None else given
    if isinstance(sys.stdout, io.TextIOWrapper):  # code pages, as on Windows, lack some characters
        sys.stdout.reconfigure(errors="backslashreplace")
    parser = _Parser(prog=prog, description=text, formatter_class=_Help)
    if version is not None:
        parser.add_argument("--version", action="version", version=version)
    if given and not given[0].startswith("-") and given[0] not in commands:
        parser.error(f"unknown command {given[0]}{suggestion(given[0], commands)}")
    choices = parser.add_subparsers(dest="command", required=True, metavar="command")
    parsers = {}
    for name, each in commands.items():
        first = each.text.partition("\n")[0].rstrip(".")
        parsers[name] = choices.add_parser(
            name, help=first, description=each.text, formatter_class=_Help
        )
        each.add_arguments(parsers[name])
    options, unknown = parser.parse_known_args(given)
    if unknown:
        parsers[options.command].refuse(unknown)
    options.parser = parser
    called = f"{prog} {options.command}"
    try:
        ctrl_c.raise_again()
        with _one_line_warnings(called):
            status = commands[options.command].run(options)
        print(end="", flush=True)  # noqa: T201 - a failure later would go unseen
    except KeyboardInterrupt as interrupt:
        kept = "; ".join(getattr(interrupt, "__notes__", ()))
        _tell(called, f"interrupted{kept and f': {kept}'}")
        return 128 + signal.SIGINT
    except BrokenPipeError:
        _give_up_output()  # the reader closed the pipe, like `head`
        return 128 + _SIGPIPE
    except OSError as error:
        is_own = isinstance(error, Crawler2dError)
        is_output = not (is_own or error.filename or isinstance(error, FileNotFoundError))
        place = "standard output" if is_output else error.filename or "working folder"
        _tell(called, str(error) if is_own else f"{place}: {error.strerror or error}")
        if is_output:
            _give_up_output()
        return 2
    except (Crawler2dError, ImportError) as error:
        _tell(called, str(error))
        return 2
    return status


def _give_up_output() -> None:
    """Discard unprinted output, or Python would complain about it at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command of the package; return its exit status."""
    given = sys.argv[1:] if arguments is None else arguments
    if given and given[0] in _MOVED:
        now = _MOVED[given[0]]
        _tell(f"crawler2d {given[0]}", f"is now `{now}`, in a clone of the project")
        return 2
    # Import only what is needed: the audit takes as long as all the rest.
    is_alone = bool(given) and given[0] in _COMMANDS and given[0] != "completion"
    named = (given[0],) if is_alone else () if "--version" in given else _COMMANDS
    commands = {}
    for name in named:
        module = import_module(f"crawler2d.commands.{name}")
        commands[name] = Command(module.__doc__ or name, module.add_arguments, module.run)
    return run_command("crawler2d", __doc__, commands, given, version=_version())


def _version() -> str:
    core = "core {build_id} ({profile}, {target})".format_map(build_info())
    return f"crawler2d {build_info()['version']}, {core}"


def _tell(called: str, text: str) -> None:
    """Print one line to standard error, unless it is closed."""
    if sys.stderr is None:  # print would use the standard output
        return
    # A terminal shows ^C at the beginning of the line.
    begin = "\n" if text.startswith("interrupted") and sys.stderr.isatty() else ""
    print(f"{begin}{called}: {' '.join(text.split())}", file=sys.stderr)  # noqa: T201


@contextmanager
def _one_line_warnings(called: str) -> Iterator[None]:
    """Show scenario warnings without the line of code that raised them."""
    with warnings.catch_warnings():
        others = warnings.showwarning

        def show(message: Warning | str, category: type[Warning], *where: object) -> None:
            if issubclass(category, ScenarioWarning):
                _tell(called, f"warning: {message}")
            else:
                others(message, category, *where)  # type: ignore[arg-type]

        warnings.showwarning = show  # type: ignore[assignment]
        yield


class _Help(argparse.HelpFormatter):
    """Keeps the paragraphs of a description separate."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        return "\n\n".join(
            textwrap.fill(" ".join(each.split()), width, initial_indent=indent)
            for each in text.strip().split("\n\n")
        )


class _Parser(argparse.ArgumentParser):
    """Reports wrong options in one line, with the nearest known one."""

    def parse_known_args(  # type: ignore[override] # its overloads are of one namespace
        self, args: Sequence[str] | None = None, namespace: Any = None
    ) -> Any:
        """Accept a choice that begins with a minus, as in ``--forward -x``, as a value."""
        given = list(sys.argv[1:] if args is None else args)
        for k in range(len(given) - 1, 0, -1):
            action = self._option_string_actions.get(given[k - 1])
            if (
                given[k].startswith("-")
                and action is not None
                and given[k] in (action.choices or ())
            ):
                given[k - 1 : k + 1] = [f"{given[k - 1]}={given[k]}"]
        return super().parse_known_args(given, namespace)

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message}; {self.prog} --help lists the options\n")

    def refuse(self, unknown: Sequence[str]) -> NoReturn:
        name = unknown[0].partition("=")[0]
        if not name.startswith("-"):
            self.error(f"one argument too many: {unknown[0]}")
        options = [each for action in self._actions for each in action.option_strings]
        self.error(f"unknown option {name}{suggestion(name, options)}")


if __name__ == "__main__":
    sys.exit(main())
