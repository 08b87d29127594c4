"""What an audit says while it runs: its parts as they come, and how many runs are made."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import TextIO

from crawler2d.errors import ScenarioError
from crawler2d.runs.progress import Progress

__all__ = ["Counted", "Live", "live_of"]


class Live:
    """Prints the parts of an audit as they come, and on a terminal counts runs in a line below.

    Parameters
    ----------
    out : text stream
        Where the parts go. Runs are counted on the standard error, if that is a terminal.
    spell : callable
        How the parts are spelt.
    """

    def __init__(self, out: TextIO, spell: Callable[[str], str] = str) -> None:
        self._out, self._spell = out, spell
        self._begin = time.monotonic()

    def tell(self, text: str) -> None:
        """Print a part."""
        self._write("\r\x1b[K")
        print(self._spell(text), file=self._out, flush=True)

    def __call__(self, done: int, total: int) -> None:
        """Count runs."""
        passed = time.monotonic() - self._begin
        self._write(f"\r\x1b[K{done} of at most {total} runs, {passed:.0f} s\r")

    def _write(self, text: str) -> None:
        if sys.stderr.isatty():
            sys.stderr.write(text)
            sys.stderr.flush()


class Counted:
    """Counts the runs of an audit over all of its batches.

    Parameters
    ----------
    show : Progress, optional
        Given the number of finished runs, and of all that may be needed.
    total : int
        That number.
    """

    def __init__(self, show: Progress | None, total: int) -> None:
        self._show, self._total, self._done = show, total, 0

    def part(self) -> Progress | None:
        """Return what counts the next batch."""
        before = self._done

        def show(done: int, _: int) -> None:
            self._done = before + done
            self._total = max(self._total, self._done)
            if self._show is not None:
                self._show(self._done, self._total)

        return show


def live_of(progress: object) -> tuple[Callable[[str], None], Progress | None]:
    """Read the argument `progress` of `audit`: what tells the parts, and what counts the runs.

    Raises
    ------
    ScenarioError
        If it is neither True, False, None nor a callable.
    """
    if progress is True:
        progress = Live(sys.stderr)
    if isinstance(progress, Live):
        return progress.tell, progress
    if progress is None or progress is False:
        return lambda _: None, None
    if not callable(progress):
        raise ScenarioError("progress", progress, "must be True, False or a callable")
    return lambda _: None, progress
