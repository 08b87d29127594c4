"""Texts that tests keep as a whole: what is said, and accounts of what is read or made.

What differs from the kept text is a fault, or is meant. With CRAWLER2D_KEEP=1 in the environment
the tests write it anew, if one process runs them: look at the difference before it is committed.
Sentences in `said.txt` are only added; what is said no more goes if that file is emptied before.
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
# Where pytest's folders and objects are, and what libraries say, which differs by version.
ELSEWHERE = re.compile(r"(file://)?/\S*/pytest-of-[^/]+/pytest-\d+/(popen-gw\d+/)?[^/ ]+")
PATH = re.compile(r"\bgot (FOLDER|ELSEWHERE|ROOT)[^;:,]*")
"""As a value, of which the end is left out if its folder has a long name."""
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
    """Compare sentences with those that a file keeps; a folder is told as FOLDER."""
    kept = kept_in(file)
    said = {plain(each, folder) for each in sentences}
    if IS_KEPT_ANEW and not said <= kept:
        kept |= said
        file.write_text("".join(f"{each}\n" for each in sorted(kept)), encoding="utf-8")
    assert said <= kept, f"not in {file}: {sorted(said - kept)}"


def plain(sentence: str, folder: Path | None) -> str:
    """Write a sentence on one line of ASCII, without what differs from run to run."""
    told = sentence if folder is None else sentence.replace(str(folder), "FOLDER")
    told = PATH.sub("got a path", ELSEWHERE.sub("ELSEWHERE", told).replace(ROOT, "ROOT"))
    told = OTHERS.sub(r"\1", " ".join(ADDRESS.sub("x...>", told).split()))
    return told.encode("unicode_escape").decode()


@contextmanager
def refusing(
    file: Path, match: str | None = None
) -> Iterator[pytest.ExceptionInfo[c2d.ScenarioError]]:
    """Expect a refusal whose sentence is kept in a file."""
    with pytest.raises(c2d.ScenarioError, match=match) as caught:
        yield caught
    check_said(file, [str(caught.value)])
