"""What commands share: they read scenarios, check where they will write, and show pages."""

from __future__ import annotations

import os
import shlex
import sys
import webbrowser
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from crawler2d.errors import ScenarioError
from crawler2d.parameters.scenario import Scenario

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

__all__ = [
    "OUT",
    "check_out",
    "check_place",
    "check_places",
    "keeping",
    "read_data",
    "read_scenario",
    "scenario_of",
    "show_page",
]

OUT = Path("out")
"""Folder of the pages whose place is not given."""

STANDARD_INPUT = Path("-")


def read_data(path: Path) -> bytes:
    """Read a file; ``-`` is the standard input.

    Raises
    ------
    ScenarioError
        If it cannot be read.
    """
    if path == STANDARD_INPUT:
        return sys.stdin.buffer.read()
    try:
        return path.read_bytes()
    except OSError as error:
        rule = f"must be a file that can be read ({error.strerror or error})"
        raise ScenarioError("FILE", str(path), rule) from None


def read_scenario(path: Path) -> Scenario:
    """Read a scenario file; errors are those of `read_data` and `scenario_of`."""
    return scenario_of(read_data(path), path)


def scenario_of(data: bytes, path: Path) -> Scenario:
    """Read a scenario from the content of a file.

    Raises
    ------
    ScenarioError
        If it is no scenario, or the scenario breaks a rule.
    """
    rule, start = "must be a scenario as JSON, as Scenario.to_json writes it", data.lstrip()[:2]
    other = ""
    if not start:
        other = "; it is empty"
    elif start == b"PK":
        other = f"; if it is a saved run: crawler2d view {shlex.quote(str(path))}"
    elif start.startswith(b"<"):
        other = f"; if it is a model file: crawler2d audit {shlex.quote(str(path))}"
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        other = other or "; it is no text in UTF-8"
    if other:
        raise ScenarioError("FILE", str(path), f"{rule}{other}")
    return Scenario.from_json(text)


def check_place(option: str, path: Path | None) -> None:
    """Refuse a place that could not be written after the work; None asks for no file.

    Raises
    ------
    ScenarioError
        If it is no file in a folder that exists.
    """
    if path is None:
        return
    is_taken = path.exists() and not path.is_file()
    if is_taken or not path.parent.is_dir() or not os.access(path.parent, os.W_OK):
        rule = "must be a file in a folder that exists and can be written"
        raise ScenarioError(option, str(path), rule)


def check_places(
    places: Mapping[str, Path | None], *, read: Sequence[Path] = (), kept: Path | None = None
) -> None:
    """Refuse places as `check_place` does, and those where one file would take another's place.

    Parameters
    ----------
    places : mapping of str to Path or None
        By option; None asks for no file.
    read : sequence of Path
        Files that are read.
    kept : Path, optional
        A store.

    Raises
    ------
    ScenarioError
        If there are some.
    """
    taken = {os.path.realpath(path): "the one that is read" for path in read}
    if kept is not None:
        taken[os.path.realpath(kept)] = "the store"
    for option, path in places.items():
        check_place(option, path)
        if path is not None:
            place = os.path.realpath(path)
            if place in taken:
                raise ScenarioError(option, str(path), f"must be another file than {taken[place]}")
            taken[place] = f"that of {option}"


def check_out(option: str) -> None:
    """Refuse the folder of pages without a place, if it could not be written after the work.

    Raises
    ------
    ScenarioError
        If so; `option` names the place of the page.
    """
    folder = OUT if OUT.exists() else OUT.absolute().parent
    if not folder.is_dir() or not os.access(folder, os.W_OK):
        rule = f"must be given: {OUT} is no folder that can be written"
        raise ScenarioError(option, None, rule)


@contextmanager
def keeping(written: list[Path]) -> Iterator[None]:
    """Let Ctrl-C say which of the files that were asked for is there."""
    try:
        yield
    except KeyboardInterrupt as interrupt:
        names = " and ".join(map(str, written))
        interrupt.add_note(f"{names} is complete" if names else "no file was written")
        raise


def show_page(path: Path) -> None:
    """Open a page in the browser of the system, or say that there is none."""
    if not webbrowser.open(path.resolve().as_uri()):
        print(f"no browser was found: open {path} yourself", file=sys.stderr)
