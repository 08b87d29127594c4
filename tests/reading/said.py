"""All that the reader says of the robots of these tests, word for word: `said.txt`.

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

KEPT = Path(__file__).with_name("said.txt")


@cache
def kept() -> set[str]:
    return set(KEPT.read_text(encoding="utf-8").splitlines())


def plain(sentence: str, folder: Path) -> str:
    """Write a sentence on one line, without what differs from run to run."""
    told = ELSEWHERE.sub("ELSEWHERE", sentence.replace(str(folder), "FOLDER"))
    return OTHERS.sub(r"\1", " ".join(told.split()))


def check_said(sentences: Iterable[str], folder: Path) -> None:
    """Compare sentences with the kept ones."""
    said = {plain(each, folder) for each in sentences}
    if os.environ.get("CRAWLER2D_KEEP_SAID") and not said <= kept():
        kept().update(said)
        KEPT.write_text("".join(f"{each}\n" for each in sorted(kept())), encoding="utf-8")
    assert said <= kept(), f"not in {KEPT.name}: {sorted(said - kept())}"
