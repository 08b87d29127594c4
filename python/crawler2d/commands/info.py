"""Print versions, threads and optional packages, for bug reports."""

from __future__ import annotations

import argparse
import importlib.metadata
import json
import os
import platform
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np

from crawler2d import _core
from crawler2d.runs.progress import thread_count

__all__ = ["add_arguments", "run"]

_VARIABLES = ("CRAWLER2D_THREADS", "CRAWLER2D_MEMORY")
_NEEDED = re.compile(r"""([\w.-]+).*;.*extra *== *['"]([\w.-]+)['"]""")
"""A package of an extra, as listed in the metadata of an installed package."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``crawler2d info``."""
    parser.add_argument("--json", action="store_true", help="print JSON instead of text")


def run(options: argparse.Namespace) -> int:
    """Print what is installed; return the exit status."""
    found = installed()
    print(json.dumps(found, indent=2) if options.json else _text_of(found))
    return 0


def installed() -> dict[str, Any]:
    """Collect versions, paths, threads and optional packages as plain data."""
    build = _core.build_info()
    return {
        "crawler2d": {"version": build["version"], "path": str(Path(__file__).parents[1])},
        "core": {**build, "path": str(_core.__file__)},
        "python": {"version": platform.python_version(), "path": sys.executable},
        "numpy": {"version": np.__version__, "path": str(Path(np.__file__).parent)},
        "system": platform.platform(),
        "threads": thread_count(None),
        "variables": {name: os.environ.get(name) for name in _VARIABLES},
        "extras": _extras(),
    }


def _extras() -> dict[str, dict[str, dict[str, str] | None]] | None:
    """List the packages of each extra; None for missing ones, and for unknown extras."""
    try:
        needed = importlib.metadata.requires("crawler2d") or []
    except importlib.metadata.PackageNotFoundError:
        return None
    extras: dict[str, dict[str, dict[str, str] | None]] = {}
    for each in needed:
        match = _NEEDED.fullmatch(each)
        if match and match[1] != "crawler2d":
            extras.setdefault(match[2], {})[match[1]] = _package(match[1])
    return extras


def _package(name: str) -> dict[str, str] | None:
    try:
        found = importlib.metadata.distribution(name)
    except importlib.metadata.PackageNotFoundError:
        return None
    return {"version": found.version, "path": str(found.locate_file(""))}


def _text_of(found: dict[str, Any]) -> str:
    core = found["core"]
    made = ", ".join(str(core[name]) for name in ("build_id", "profile", "target", "engine"))
    rows = [
        ("crawler2d", f"{found['crawler2d']['version']} in {found['crawler2d']['path']}"),
        ("core", made),
        ("", core["path"]),
        ("scenario files", f"version {core['schema']}"),
        ("Python", f"{found['python']['version']}, {found['python']['path']}"),
        ("numpy", f"{found['numpy']['version']} in {found['numpy']['path']}"),
        ("system", found["system"]),
        ("threads", str(found["threads"])),
        *((name, value or "not set") for name, value in found["variables"].items()),
    ]
    if found["extras"] is None:
        rows.append(("extras", "not known: crawler2d is not installed as a package"))
    for extra, packages in (found["extras"] or {}).items():
        there = [f"{name} {each['version']}" for name, each in packages.items() if each]
        missing = [name for name, each in packages.items() if not each]
        texts = [", ".join(there)] if there else []
        if missing:
            install = f"pip install 'crawler2d[{extra}]'"
            texts.append(f"missing {', '.join(missing)}: {install}")
        rows.append((f"extra {extra}", "; ".join(texts)))
    wide = max(len(name) for name, _ in rows)
    return "\n".join(f"{name:{wide}}  {text}" for name, text in rows)
