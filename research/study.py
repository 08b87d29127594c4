"""The framework of a study: its options, and the files that it writes."""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import crawler2d as c2d
from crawler2d.__main__ import Command
from research.tables import write_csv

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, slots=True)
class Job:
    """A study started from a command line."""

    options: argparse.Namespace

    @property
    def out(self) -> Path:
        """The folder for its files."""
        folder: Path = self.options.out
        return folder

    @property
    def full(self) -> bool:
        """Whether to run the full study."""
        return bool(self.options.full)

    @property
    def sampling(self) -> dict[str, Any]:
        """Seed and threads, as `sweep` takes them."""
        return {"seed": self.options.seed, "threads": self.options.threads}

    def report(self, name: str, text: str, *printed: str) -> None:
        """Print a text, and write it as NAME.txt, after everything printed during the runs."""
        print(f"\n{text}\n")
        whole = "\n\n\n".join((*printed, text))
        (self.out / f"{name}.txt").write_text(f"{whole}\n", encoding="utf-8")

    def write_rows(self, **tables: Sequence[Any]) -> None:
        """Write rows of dataclasses as NAME.csv; a table without rows is left out."""
        for name, rows in tables.items():
            if rows:
                write_csv(self.out / f"{name}.csv", rows)

    def draw(self, figures: Mapping[str, Callable[[], Figure]], also: Iterable[Path] = ()) -> None:
        """Draw figures as NAME.png, also in other folders; print a note without matplotlib."""
        try:
            for name, figure in figures.items():
                picture = self.out / f"{name}.png"
                figure().savefig(picture, dpi=100)
                for folder in also:
                    shutil.copy(picture, folder)
        except ImportError as missing:
            print(f"no picture: {missing}", file=sys.stderr)


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """A command of `python -m research`."""

    text: str
    """Its question."""
    run: Callable[[Job], None]
    full: str | None = "all heights and repeats; minutes"
    """Size and time of `--full`; None if there is only one design."""
    add_options: Callable[[argparse.ArgumentParser], None] | None = None
    """Adds options of this study."""

    def command(self) -> Command:
        """Make its command, which Ctrl-C ends with an exit status of 130."""
        return Command(self.text, self._add_arguments, self._run)

    def _add_arguments(self, parser: argparse.ArgumentParser) -> None:
        if self.full is not None:
            parser.add_argument("--full", action="store_true", help=self.full)
        parser.add_argument("--out", type=Path, default=Path("out"), help="folder for the results")
        parser.add_argument("--threads", type=int, default=None, help="default: all cores")
        parser.add_argument("--seed", type=int, default=0, help="seed of the draws (default: 0)")
        if self.add_options is not None:
            self.add_options(parser)

    def _run(self, options: argparse.Namespace) -> int:
        options.out.mkdir(parents=True, exist_ok=True)
        try:
            self.run(Job(options))
        except c2d.BatchInterrupted as interrupt:
            print(interrupt, file=sys.stderr)
            return 130
        return 0
