"""CONTRIBUTING.md is a map: what it names is there, and every file of core and package is named."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.walls.houses import HOUSES, files_of
from tests.walls.rooms import ROOT, House

TEXT = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")


def rows(head: str) -> Iterator[tuple[list[str], list[str]]]:
    """Yield the names in the two cells of each row of the table under a line."""
    table = TEXT.partition(head)[2].partition("| holds |")[2].partition("\n\n")[0]
    for line in table.splitlines()[2:]:
        _, names, holds, _ = line.split("|")
        yield re.findall("`([^`]+)`", names), re.findall("`([^`]+)`", holds)


FOLDERS = list(rows("## Where new code goes"))
ROOMS = {name: list(rows(f"The rooms of the {name}")) for name in HOUSES}


def holding(name: str) -> Iterator[tuple[str, list[str]]]:
    """Yield every room of a table and what its row says that it holds."""
    for rooms, held in ROOMS[name]:
        yield from ((room, held) for room in rooms)


def test_every_folder_that_is_named_is_there() -> None:
    assert len(FOLDERS) >= 5
    named = [name for names, _ in FOLDERS for name in names]
    named += [name for _, held in FOLDERS for name in held if "/" in name]
    assert [name for name in named if not (ROOT / name).is_dir()] == []


@pytest.mark.parametrize("name", HOUSES)
def test_every_room_that_is_named_is_there(name: str) -> None:
    folder = House.read(name).folder
    named = [room for room, _ in holding(name)]
    assert len(named) > 10
    assert [room for room in named if not (folder / room).exists()] == []
    assert [room for room in named if (folder / room).is_dir() != room.endswith("/")] == []


@pytest.mark.parametrize("name", HOUSES)
def test_every_file_that_is_named_in_a_room_is_there(name: str) -> None:
    folder = House.read(name).folder
    gone = [
        f"{room}: {each}"
        for room, held in holding(name)
        if room.endswith("/")
        for each in held
        if re.fullmatch(r"[\w./]+", each) and not any(found(folder / room, each))
    ]
    assert gone == []


def found(room: Path, name: str) -> Iterator[Path]:
    """Yield what a name in the row of a room can mean, there or in a folder of it."""
    for ending in ("", ".rs", ".py"):
        yield from room.rglob(name.rstrip("/") + ending)


@pytest.mark.parametrize("name", HOUSES)
def test_every_file_is_named(name: str) -> None:
    house = House.read(name)
    named = list(holding(name))
    missing = [
        file
        for file in files_of(house)
        if not any(
            file == room or (room.endswith("/") and file.startswith(room) and is_said(file, held))
            for room, held in named
        )
    ]
    assert missing == []


def is_said(file: str, held: list[str]) -> bool:
    """Whether a row names a file; what only makes a folder a module needs no word."""
    stem = Path(file).stem
    return stem in held or stem in ("mod", "__init__", "__main__")


@pytest.mark.parametrize("name", HOUSES)
def test_the_rooms_stand_in_the_order_in_which_they_are_listed(name: str) -> None:
    house = House.read(name)
    assert [room for room, _ in holding(name) if room in house.rooms] == list(house.rooms)
    assert [room for room, _ in holding(name) if house.floor(room) is None] == []


def test_every_link_leads_somewhere() -> None:
    links = re.findall(r"\]\(([^)#]+)\)", TEXT)
    assert links
    assert [link for link in links if not (ROOT / link).exists()] == []
