"""Timing of several jobs in turns, pools of processes, the machine, and the parts of a page."""

import datetime
import os
import platform
import sys
import textwrap
import time
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack, contextmanager
from multiprocessing import get_context
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from crawler2d import wilson
from research.tables import splice_into

Key = TypeVar("Key", bound=Hashable)

_SPINS = 2_000_000


def seconds(job: Callable[[], object]) -> float:
    """[s] Time a job."""
    start = time.perf_counter()
    job()
    return time.perf_counter() - start


def interleaved(jobs: Mapping[Key, Callable[[], float]], repeats: int) -> dict[Key, float]:
    """[s] Time all jobs once, then all of them again; return the least time of each.

    So disturbances affect all jobs.

    Parameters
    ----------
    jobs : mapping of callables
        Each does its job and returns the seconds [s] it took.
    repeats : int
        Number of rounds.
    """
    rounds = [{key: job() for key, job in jobs.items()} for _ in range(repeats)]
    return {key: min(times[key] for times in rounds) for key in jobs}


@contextmanager
def pools(
    counts: Sequence[int], warm: Callable[[int], None]
) -> Iterator[dict[int, ProcessPoolExecutor]]:
    """Open one pool per number of processes; each process has run `warm`."""
    context = get_context("spawn")
    with ExitStack() as stack:
        opened = {n: stack.enter_context(ProcessPoolExecutor(n, context)) for n in counts}
        for count, pool in opened.items():
            list(pool.map(warm, range(4 * count)))
        yield opened


def spread(pool: ProcessPoolExecutor, work: Callable[[Any], None], tasks: Sequence[Any]) -> float:
    """[s] Run all tasks in a pool."""
    return seconds(lambda: list(pool.map(work, tasks)))


def spin(pool: ProcessPoolExecutor, loops: int) -> float:
    """[s] Run counting loops in a pool, which show the gain of more cores."""
    return spread(pool, _count, [_SPINS] * loops)


def _count(down: int) -> None:
    while down > 0:
        down -= 1


def machine(versions: Mapping[str, str]) -> dict[str, Any]:
    """Describe the processor, its load, the interpreter and the measured versions."""
    return {
        "date": datetime.datetime.now(datetime.UTC).date().isoformat(),
        "processor": _processor(),
        "cores": os.cpu_count(),
        "load": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "versions": dict(versions),
    }


def _processor() -> str:
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or "unknown"


def sentence(machine: Mapping[str, Any], wall: float) -> str:
    """Write the result of `machine`, and the duration [s] of the measurement."""
    versions = ", ".join(f"{name} ({version})" for name, version in machine["versions"].items())
    load = "unknown" if machine["load"] is None else f"{machine['load']:.1f}"
    return (
        f"Measured on {machine['date']} in {wall / 60.0:.0f} minutes: {machine['processor']},"
        f" {machine['cores']} cores, load {load} at the beginning, {machine['system']},"
        f" Python {machine['python']}. Versions: {versions}."
    )


def write_parts(
    parts: Mapping[str, str], page: Path | None = None, report: Path | None = None
) -> None:
    """Print the parts of a study, write all of them into a report, and some into a page.

    The page has marks for those that it shows.
    """
    parts = {name: "\n\n".join(map(_wrapped, part.split("\n\n"))) for name, part in parts.items()}
    text = "\n\n".join(f"## {name}\n\n{part}" for name, part in parts.items()) + "\n"
    sys.stdout.write(text)
    if report is not None:
        report.write_text(text, encoding="utf-8", newline="\n")
    if page is not None:
        splice_into(page, parts)


def _wrapped(block: str) -> str:
    """Wrap a paragraph, whose length depends on figures."""
    is_paragraph = not block.startswith(("|", "#", "-", "!"))
    return textwrap.fill(block, 100, break_on_hyphens=False) if is_paragraph else block


def rate(count: int, of: int) -> str:
    """Write a rate with its Wilson 95 % interval in percent.

    Examples
    --------
    >>> rate(1, 2)
    '1/2 (9 to 91)'
    """
    interval = wilson(count, of)
    return f"{count}/{of} ({100.0 * interval.low:.0f} to {100.0 * interval.high:.0f})"


def quantiles(values: Sequence[float], form: str = ".2g") -> str:
    """Write the median and the 90th percentile, if there are values."""
    found = np.quantile(values, (0.5, 0.9)) if len(values) else ()
    return ", ".join(f"{each:{form}}" for each in found)


def millimetres(length: float, least: float = 0.0) -> str:
    """Write a length in mm with two digits; 0 below `least` [mm]."""
    value = 1e3 * length
    return f"{value:.0f}" if value >= 100.0 else f"{value:.2g}" if value >= least else "0"
