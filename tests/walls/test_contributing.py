"""CONTRIBUTING.md is a map: what it names is there, and every room of core and package is named."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
CORE, PACKAGE = ROOT / "rust_core/src", ROOT / "python/crawler2d"


def rows(head: str) -> Iterator[tuple[list[str], str]]:
    """Yield the names in the first cell of each row of the table under a line, and its text."""
    table = TEXT.partition(head)[2].partition("| holds |")[2].partition("\n\n")[0]
    for line in table.splitlines()[2:]:
        _, names, holds, _ = line.split("|")
        yield re.findall("`([^`]+)`", names), holds


FOLDERS = list(rows("## Where new code goes"))
ROOMS = {
    CORE: list(rows("The rooms of the core")),
    PACKAGE: list(rows("The rooms of the package")),
}


def test_every_folder_that_is_named_is_there() -> None:
    assert len(FOLDERS) >= 5
    named = [
        name for names, holds in FOLDERS for name in [*names, *re.findall("`([^`]+/.+?)`", holds)]
    ]
    assert [name for name in named if not (ROOT / name).is_dir()] == []


@pytest.mark.parametrize("root", ROOMS, ids=lambda root: root.name)
def test_every_room_that_is_named_is_there(root: Path) -> None:
    named = [name for names, _ in ROOMS[root] for name in names]
    assert len(named) > 25
    gone = [name for name in named if not (root / name).exists()]
    assert gone == []
    assert [name for name in named if (root / name).is_dir() != name.endswith("/")] == []


@pytest.mark.parametrize("root", ROOMS, ids=lambda root: root.name)
def test_every_file_that_is_named_in_a_room_is_there(root: Path) -> None:
    for names, holds in ROOMS[root]:
        for room in (root / name for name in names if name.endswith("/")):
            for name in re.findall("`([^`]+)`", holds):
                there = [room / f"{name}{ending}" for ending in ("", ".rs", ".py")]
                assert any(path.exists() for path in there), f"{room.name}: {name}"


@pytest.mark.parametrize("root", ROOMS, ids=lambda root: root.name)
def test_every_room_is_named(root: Path) -> None:
    named = {name.strip("/").split("/")[0] for names, _ in ROOMS[root] for name in names}
    files = {path.name for path in root.iterdir() if path.name != "py.typed"}
    there = {
        name
        for name in files
        # Tests beside a file lie in a folder of its name.
        if not name.startswith("__") and not name.endswith(".so") and f"{name}.rs" not in files
    }
    assert there - named == set()


def test_every_link_leads_somewhere() -> None:
    links = re.findall(r"\]\(([^)#]+)\)", TEXT)
    assert links
    assert [link for link in links if not (ROOT / link).exists()] == []
