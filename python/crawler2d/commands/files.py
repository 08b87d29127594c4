"""Shared by commands: read scenarios, check output paths, and show pages."""

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
"""Default folder of pages."""

STANDARD_INPUT = Path("-")


def read_data(path: Path) -> bytes:
    """Read a file; ``-`` is the standard input.

    Raises
    ------
    ScenarioError
        If the file cannot be read.
    """
    if path == STANDARD_INPUT:
        return sys.stdin.buffer.read()
    try:
        return path.read_bytes()
    except OSError as error:
        rule = f"must be a file that can be read ({error.strerror or error})"
        raise ScenarioError("FILE", str(path), rule) from None


def read_scenario(path: Path) -> Scenario:
    """Read a scenario file; raises the errors of `read_data` and `scenario_of`."""
    return scenario_of(read_data(path), path)


def scenario_of(data: bytes, path: Path) -> Scenario:
    """Read a scenario from the content of a file.

    Raises
    ------
    ScenarioError
        If it is not a scenario, or breaks a rule.
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
        other = other or "; it is not UTF-8 text"
    if other:
        raise ScenarioError("FILE", str(path), f"{rule}{other}")
    return Scenario.from_json(text)


def check_place(option: str, path: Path | None) -> None:
    """Refuse an output path that cannot be written; None means no file.

    Raises
    ------
    ScenarioError
        If it is not a file in an existing folder.
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
    """Refuse output paths as `check_place` does, and paths that would overwrite another file.

    Parameters
    ----------
    places : mapping of str to Path or None
        Paths by option; None means no file.
    read : sequence of Path
        Input files.
    kept : Path, optional
        A store.

    Raises
    ------
    ScenarioError
        If a path is refused.
    """
    taken = {os.path.realpath(path): "the input file" for path in read}
    if kept is not None:
        taken[os.path.realpath(kept)] = "the store"
    for option, path in places.items():
        check_place(option, path)
        if path is not None:
            place = os.path.realpath(path)
            if place in taken:
                raise ScenarioError(option, str(path), f"must differ from {taken[place]}")
            taken[place] = option


def check_out(option: str) -> None:
    """Refuse the default folder of pages if it cannot be written.

    Raises
    ------
    ScenarioError
        If so; `option` is the one that sets the page's path.
    """
    folder = OUT if OUT.exists() else OUT.absolute().parent
    if not folder.is_dir() or not os.access(folder, os.W_OK):
        rule = f"must be given: {OUT} is not a writable folder"
        raise ScenarioError(option, None, rule)


@contextmanager
def keeping(written: list[Path]) -> Iterator[None]:
    """Add a note to Ctrl-C that lists the complete files."""
    try:
        yield
    except KeyboardInterrupt as interrupt:
        names = " and ".join(map(str, written))
        interrupt.add_note(f"{names} is complete" if names else "no file was written")
        raise


def show_page(path: Path) -> None:
    """Open a page in the system's browser, or report that there is none."""
    if not webbrowser.open(path.resolve().as_uri()):
        print(f"no browser was found: open {path} yourself", file=sys.stderr)
