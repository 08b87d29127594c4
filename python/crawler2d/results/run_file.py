"""A run in one file: arrays in NumPy's .npz, text as JSON, nothing pickled."""

from __future__ import annotations

import json
import os
import zipfile
import zlib
from collections.abc import Callable, Mapping
from typing import IO, TYPE_CHECKING, Any, TypeVar

import numpy as np

from crawler2d.common.files import written_whole
from crawler2d.errors import ScenarioError, StoreError
from crawler2d.parameters.scenario import Scenario
from crawler2d.results.record import diagnosis_json, read_diagnosis

if TYPE_CHECKING:
    from pathlib import Path

    from crawler2d.results.record import Record

__all__ = ["SIGNATURE", "check_suffix", "read_open_run", "read_run", "write_run"]

R = TypeVar("R")

SIGNATURE = b"PK\x03\x04"
"""First bytes of a .npz, which is a zip file."""

_SUFFIX = ".npz"
_FORMAT = "crawler2d run"
_VERSION = 1

_TABLES = ("edges", "events", "contacts")
_OF_STOP = "diagnosis/contacts"

_AGAIN = "copy it again from where it was saved, or simulate its scenario again"
_CUT = f"is cut short or damaged: {_AGAIN}"
_OTHER = "is not a saved run: Run.save writes them, and Scenario.from_json reads scenarios"


def check_suffix(path: Path, name: str) -> None:
    """Refuse a path with the suffix of another format; `name` is the argument's.

    Raises
    ------
    ScenarioError
        If the suffix is wrong.
    """
    if path.suffix.lower() not in ("", _SUFFIX):
        rule = f"must end in {_SUFFIX}, the format of saved runs, or have no suffix"
        raise ScenarioError(name, path.name, rule)


def write_run(run: Record, path: Path) -> None:
    """Write a run that has a result; see `Run.save`."""
    if run.error is not None:
        rule = f"must have a result to be saved, not the error {run.error}"
        raise ScenarioError("run", run, rule)
    _, (scenario, result, _, parent) = run.__reduce__()
    tables = {name: result[name] for name in _TABLES}
    diagnosis = result["diagnosis"]
    if diagnosis is not None:
        tables[_OF_STOP], diagnosis["contacts"] = diagnosis["contacts"], {}
    about = {
        "format": _FORMAT,
        "version": _VERSION,
        "build": result["build"],
        "outcome": result["outcome"],
        "wall_time": result["wall_time"],
        "trunk": None if parent is None else [parent[0].to_json(), parent[1]],
        "tables": {name: _texts(columns) for name, columns in tables.items()},
    }
    arrays = {
        "about": np.array(json.dumps(about)),
        "scenario": np.array(scenario.to_json()),
        "diagnosis": np.array("" if diagnosis is None else diagnosis_json(diagnosis)),
        "metrics/names": np.array(list(result["metrics"])),
        "metrics/values": np.array(list(result["metrics"].values())),
        **{f"trace/{name}": array for name, array in result["trace"].items()},
        **{
            f"{table}/{name}": column
            for table, columns in tables.items()
            for name, column in columns.items()
            if not _is_text(column)
        },
    }
    with written_whole(path) as file:
        np.savez_compressed(file, allow_pickle=False, **arrays)


def _is_text(column: np.ndarray[Any, Any]) -> bool:
    """Whether a column holds strings or tuples."""
    return column.dtype.kind in "OU"


def _texts(columns: Mapping[str, np.ndarray[Any, Any]]) -> dict[str, list[Any] | None]:
    """List the columns of a table in order, with the values of those that are not arrays."""
    return {name: each.tolist() if _is_text(each) else None for name, each in columns.items()}


def read_run(path: str | os.PathLike[str], make: Callable[..., R]) -> R:
    """Read a file of `write_run`; see `crawler2d.load`.

    Parameters
    ----------
    path : str or path-like
        The file.
    make : callable
        Called like `Record`.

    Raises
    ------
    StoreError
        If the file cannot be read, is not a run, is damaged or has a newer format.
    """
    try:
        # A number would be a file descriptor of this process, and would be closed.
        file = open(os.fspath(path), "rb")  # noqa: SIM115 - later errors have other causes
    except OSError as error:
        raise StoreError(f"{path} cannot be read: {error.strerror or error}") from None
    with file:
        return read_open_run(file, path, make)


def read_open_run(file: IO[bytes], path: str | os.PathLike[str], make: Callable[..., R]) -> R:
    """Read a run from an open file or its content; see `read_run`."""
    if file.read(len(SIGNATURE)) != SIGNATURE:
        raise StoreError(f"{path} {_OTHER}")
    file.seek(0)
    try:
        with _entries(file, path) as entries:
            about = _about(entries, path)
            return make(*_arguments(entries, about, path))
    except StoreError:
        raise
    except Exception as error:  # a changed file may raise anything
        fault = f"{type(error).__name__}: {error}"
        raise StoreError(f"{path} is damaged ({fault}): {_AGAIN}") from error


def _entries(file: Any, path: str | os.PathLike[str]) -> Any:
    """Open the arrays of a file after checking its checksums."""
    try:
        entries = np.load(file, allow_pickle=False)
        if entries.zip.testzip() is None:  # before using any of it
            return entries
    except (zipfile.BadZipFile, zlib.error, EOFError, OSError, RuntimeError):
        pass
    raise StoreError(f"{path} {_CUT}")


def _about(entries: Any, path: str | os.PathLike[str]) -> dict[str, Any]:
    """Read the header, and check that this version can read the rest."""
    try:
        about = json.loads(str(entries["about"]))
    except (KeyError, ValueError):
        about = None
    if not isinstance(about, dict) or about.get("format") != _FORMAT:
        raise StoreError(f"{path} {_OTHER}")
    if about["version"] > _VERSION:
        raise StoreError(
            f"{path} is of format {about['version']}, of crawler2d {about['build']['version']};"
            f" this one reads up to {_VERSION}: update crawler2d"
        )
    return about


def _arguments(
    entries: Any, about: dict[str, Any], path: str | os.PathLike[str]
) -> tuple[Scenario, dict[str, Any], None, tuple[Scenario, float] | None]:
    """Read the arguments of a `Record`."""
    tables = {
        table: {
            name: entries[f"{table}/{name}"] if texts is None else texts
            for name, texts in columns.items()
        }
        for table, columns in about["tables"].items()
    }
    diagnosis = None
    if text := str(entries["diagnosis"]):
        diagnosis = read_diagnosis(text)
        diagnosis["contacts"] = tables.pop(_OF_STOP)
    result = {
        **{name: tables[name] for name in _TABLES},
        "outcome": about["outcome"],
        "build": about["build"],
        "wall_time": about["wall_time"],
        "diagnosis": diagnosis,
        "metrics": _metrics(entries),
        "trace": {
            name.removeprefix("trace/"): entries[name]
            for name in entries.files
            if name.startswith("trace/")
        },
    }
    stored = about["trunk"]
    try:
        parent = None if stored is None else (Scenario.from_json(stored[0]), float(stored[1]))
        return Scenario.from_json(str(entries["scenario"])), result, None, parent
    except ScenarioError as error:
        by = about["build"]["version"]
        raise StoreError(
            f"{path} has a scenario that this crawler2d refuses, and {by} did not: {error}"
        ) from error


def _metrics(entries: Any) -> dict[str, float]:
    names, values = entries["metrics/names"].tolist(), entries["metrics/values"].tolist()
    return dict(zip(names, values, strict=True))
