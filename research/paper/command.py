"""The paper, reproduced: its Tables 1 to 3, eq. (1), its claims and its figures.

Everything is simulated under settings that were chosen beforehand, and set beside what the paper
has. A store keeps every run: after Ctrl-C the same call goes on where it was.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from crawler2d.runs.batch import BatchInterrupted
from research.paper.design import FULL, QUICK, Work
from research.paper.parts import PARTS, Pages

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``python -m research paper``."""
    parser.add_argument("--full", action="store_true", help="all of it; an hour or two")
    parser.add_argument("--out", type=Path, default=Path("out"), help="folder for the results")
    parser.add_argument("--threads", type=int, default=None, help="default: all cores")
    parser.add_argument("--seed", type=int, default=0, help="seed of the draws (default: 0)")
    parser.add_argument(
        "--table",
        choices=sorted({part.option for part in PARTS}),
        action="append",
        help="only this part; may be given more than once",
    )
    parser.add_argument(
        "--into", type=Path, default=None, help="a page in Markdown whose tables to replace"
    )


def run(options: argparse.Namespace) -> int:
    """Reproduce the paper; returns the exit status."""
    out: Path = options.out
    out.mkdir(parents=True, exist_ok=True)
    work = Work(
        store=out / "paper.sqlite",
        design=FULL if options.full else QUICK,
        seed=options.seed,
        threads=options.threads,
    )
    pages = Pages(out, work, options.into)
    chosen = [part for part in PARTS if options.table is None or part.option in options.table]
    spent = _minutes()
    try:
        for part in chosen:
            begin = _minutes()
            for name, text in part.make(work, pages):
                pages.add(name, text)
            now = _minutes()
            print(f"{part.name}: {now[0] - begin[0]:.1f} min", flush=True)
    except BatchInterrupted as interrupt:
        print(interrupt, file=sys.stderr)
        return 130
    elapsed, processor = (now - then for now, then in zip(_minutes(), spent, strict=True))
    cost = f"{elapsed:.1f} min, {processor:.1f} min of processor time"
    print(f"\n{pages.text}\n\n{cost}; tables, pictures and replays are in {out}")
    return 0


def _minutes() -> tuple[float, float]:
    """[min] Read the clock, and that of the processor."""
    return time.perf_counter() / 60.0, time.process_time() / 60.0
