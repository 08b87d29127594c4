"""All that is said in some tests, word for word: kept in files called `said.txt`.

A sentence that is not there is a fault or a new wording. With CRAWLER2D_KEEP_SAID=1 in the
environment the tests add what is missing, if one process runs them; what is said no more goes if
the file is emptied before.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from functools import cache
from pathlib import Path

# Where pytest's folders are, and what libraries say, which differs from version to version.
ELSEWHERE = re.compile(r"(file://)?/\S*/pytest-of-[^/]+/pytest-\d+/(popen-gw\d+/)?[^/ ]+")
OTHERS = re.compile(r"(that (trimesh reads|MuJoCo compiles|expands)\b).*")


@cache
def kept_in(file: Path) -> set[str]:
    return set(file.read_text(encoding="utf-8").splitlines())


def check_said(file: Path, sentences: Iterable[str], folder: Path | None = None) -> None:
    """Compare sentences with those that a file keeps; a folder is told as FOLDER."""
    kept = kept_in(file)
    said = {plain(each, folder) for each in sentences}
    if os.environ.get("CRAWLER2D_KEEP_SAID") and not said <= kept:
        kept |= said
        file.write_text("".join(f"{each}\n" for each in sorted(kept)), encoding="utf-8")
    assert said <= kept, f"not in {file}: {sorted(said - kept)}"


def plain(sentence: str, folder: Path | None) -> str:
    """Write a sentence on one line of ASCII, without what differs from run to run."""
    told = sentence if folder is None else sentence.replace(str(folder), "FOLDER")
    told = OTHERS.sub(r"\1", " ".join(ELSEWHERE.sub("ELSEWHERE", told).split()))
    return told.encode("unicode_escape").decode()
