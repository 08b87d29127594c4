"""Stored results: compressed JSON that is complete at any time, and a list of checksums.

``python -m benches.shared.results`` writes the list again after a program has added results.
"""

import hashlib
import json
import lzma
import os
import signal
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path
from typing import Any, TypeVar

_BENCHES = Path(__file__).parents[1]
CHECKSUMS = _BENCHES / "results.sha256"
"""SHA-256 of every stored file, in the format of `sha256sum`."""

_INTERVAL = 20.0  # [s] between two writes of a file
_START = time.perf_counter()

Job = TypeVar("Job")


def progress(text: str) -> None:
    """Write a line and the elapsed time to stderr."""
    sys.stderr.write(f"{time.perf_counter() - _START:6.1f} s  {text}\n")
    sys.stderr.flush()


def read_text(path: Path) -> str:
    """Decompress a file."""
    return lzma.decompress(path.read_bytes()).decode("utf-8")


def write_text(path: Path, text: str) -> None:
    """Compress text into a file, which keeps its old content until the new one is complete."""
    _replace(path, lzma.compress(text.encode("utf-8")))


def _replace(path: Path, data: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    new = path.with_suffix(".new")
    new.write_bytes(data)
    os.replace(new, path)


def read(path: Path, missing: Any = None) -> Any:
    """Read JSON from a file; `missing` is returned if there is no file."""
    return json.loads(read_text(path)) if path.exists() else missing


def write(path: Path, data: Any) -> None:
    """Write JSON into a file."""
    write_text(path, json.dumps(data) + "\n")


def write_rows(path: Path, rows: Iterable[Any]) -> None:
    """Write a list as JSON, one item per line, without compression."""
    lines = ",\n".join(map(json.dumps, rows))
    _replace(path, f"[\n{lines}\n]\n".encode())


def table_of(path: Path, write: Callable[[Any], str]) -> str:
    """Write a table of the results in a file, if it exists."""
    data = read(path)
    return "Not tried." if data is None else write(data)


def checksums() -> str:
    """Return the lines of `CHECKSUMS` for the files as they are."""
    return "".join(
        f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.relative_to(_BENCHES)}\n"
        for path in sorted(_BENCHES.rglob("*.json.xz"))
    )


class Results:
    """The results of a program in a file, whose runs are not repeated.

    Parameters
    ----------
    path : Path
        The file.
    empty : optional
        Content of a new file; an empty dict by default.

    Attributes
    ----------
    data
        The content, to be changed in place.
    """

    def __init__(self, path: Path, empty: Any = None) -> None:
        self.path = path
        self.data = read(path, {} if empty is None else empty)
        self._written = time.monotonic()

    def at(self, *keys: str) -> list[Any]:
        """Return the list under nested keys, empty at first."""
        node = self.data
        for key in keys[:-1]:
            node = node.setdefault(key, {})
        runs: list[Any] = node.setdefault(keys[-1], [])
        return runs

    def save(self) -> None:
        """Write the file."""
        write(self.path, self.data)
        self._written = time.monotonic()

    def add(
        self,
        jobs: Iterable[tuple[Sequence[str], Job]],
        run: Callable[[Job], Any],
        executor: Executor | None = None,
    ) -> None:
        """Run jobs and append each result to the list under its keys.

        The file is written every 20 s, at the end, and when the runs are interrupted.

        Parameters
        ----------
        jobs : iterable of (keys, job)
            What to run, and where its result belongs.
        run : callable
            Takes a job and returns its result, as JSON has it.
        executor : Executor, optional
            Runs several jobs at a time.
        """
        jobs = list(jobs)
        made = (map if executor is None else executor.map)(run, [job for _, job in jobs])
        try:
            for number, ((keys, _), result) in enumerate(zip(jobs, made, strict=True), 1):
                self.at(*keys).append(result)
                if time.monotonic() - self._written > _INTERVAL:
                    self.save()
                    progress(f"{self.path.name}: {number} runs, last of {', '.join(keys)}")
        finally:
            self.save()


@contextmanager
def processes(count: int | None = None) -> Iterator[Executor]:
    """Open processes, one per core by default; Ctrl-C ends them at once."""
    context = get_context("spawn")  # no engine is forked with its state
    pool = ProcessPoolExecutor(count, context, signal.signal, (signal.SIGINT, signal.SIG_DFL))
    try:
        yield pool
    finally:
        pool.shutdown(cancel_futures=True)


if __name__ == "__main__":
    CHECKSUMS.write_text(checksums(), encoding="utf-8", newline="\n")
