"""Stored texts of tests: messages, and descriptions of what is read or made.

A difference from the stored text is either a fault or intended. With CRAWLER2D_KEEP=1 in the
environment, tests that run in one process write it anew; check the difference before committing.
Sentences are only added to `said.txt`; empty that file first to remove those no longer used.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import pytest

import crawler2d as c2d

IS_KEPT_ANEW = os.environ.get("CRAWLER2D_KEEP") == "1"
ROOT = str(Path(__file__).parents[1])
# Paths of pytest's folders, addresses, and messages of libraries, which differ by version.
ELSEWHERE = re.compile(r"(file://)?/\S*/pytest-of-[^/]+/pytest-\d+/(popen-gw\d+/)?[^/ ]+")
PATH = re.compile(r"\bgot (FOLDER|ELSEWHERE|ROOT)[^;:,]*")
"""A path as a value, whose end is left out if its folder has a long name."""
ADDRESS = re.compile(r"x[0-9a-f]{8,}>")
OTHERS = re.compile(r"(that (trimesh reads|MuJoCo compiles|expands)\b).*")


def check_kept(file: Path, text: str) -> None:
    """Compare a text with that of a file."""
    if IS_KEPT_ANEW:
        file.parent.mkdir(exist_ok=True)
        file.write_text(text, encoding="utf-8")
    assert text.splitlines() == file.read_text(encoding="utf-8").splitlines()


@cache
def kept_in(file: Path) -> set[str]:
    return set(file.read_text(encoding="utf-8").splitlines())


def check_said(file: Path, sentences: Iterable[str], folder: Path | None = None) -> None:
    """Compare sentences with those in a file, with a folder written as FOLDER."""
    kept = kept_in(file)
    said = {plain(each, folder) for each in sentences}
    if IS_KEPT_ANEW and not said <= kept:
        kept |= said
        file.write_text("".join(f"{each}\n" for each in sorted(kept)), encoding="utf-8")
    assert said <= kept, f"not in {file}: {sorted(said - kept)}"


def plain(sentence: str, folder: Path | None) -> str:
    """Write a sentence on one line of ASCII, without parts that differ between runs."""
    told = sentence if folder is None else sentence.replace(str(folder), "FOLDER")
    told = PATH.sub("got a path", ELSEWHERE.sub("ELSEWHERE", told).replace(ROOT, "ROOT"))
    told = OTHERS.sub(r"\1", " ".join(ADDRESS.sub("x...>", told).split()))
    return told.encode("unicode_escape").decode()


@contextmanager
def refusing(
    file: Path, match: str | None = None
) -> Iterator[pytest.ExceptionInfo[c2d.ScenarioError]]:
    """Expect a refusal whose sentence is in a file."""
    with pytest.raises(c2d.ScenarioError, match=match) as caught:
        yield caught
    check_said(file, [str(caught.value)])
