"""CONTRIBUTING.md is a map: everything that it names exists, and every room has a sentence."""

import re
from collections import Counter
from collections.abc import Iterator

import pytest

from tests.walls.houses import HOUSES, files_of
from tests.walls.rooms import ROOT, House

TEXT = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")

LONGEST = 20
"""Words that say what a room holds."""

MOST = 25
"""Files of a room, its tests left out: what fits on a screen."""

LARGER = {"core": ("dynamics/",), "package": ()}


def rows(head: str) -> Iterator[tuple[str, str]]:
    """Yield the name and the text in each row of the table under a line."""
    table = TEXT.partition(head)[2].partition("| holds |")[2].partition("\n\n")[0]
    for line in table.splitlines()[2:]:
        _, name, text, _ = line.split("|")
        yield name.strip(" `"), text.strip()


FOLDERS = dict(rows("## Where new code goes"))
ROOMS = {name: dict(rows(f"The rooms of the {name}")) for name in HOUSES}


def test_every_folder_that_is_named_is_there() -> None:
    assert len(FOLDERS) >= 5
    named = [*FOLDERS, *re.findall("`([^`]+/[^`]*)`", " ".join(FOLDERS.values()))]
    assert [name for name in named if not (ROOT / name).is_dir()] == []


@pytest.mark.parametrize("name", HOUSES)
def test_every_room_has_its_sentence_in_the_order_of_the_list(name: str) -> None:
    assert list(ROOMS[name]) == list(House.read(name).rooms)
    long = [room for room, text in ROOMS[name].items() if len(text.split()) > LONGEST]
    assert long == []


@pytest.mark.parametrize("name", HOUSES)
def test_a_room_fits_on_a_screen(name: str) -> None:
    house = House.read(name)
    files = [file for file in files_of(house) if not re.search(r"(^|/)tests(/|\.rs)", file)]
    sizes = Counter(room for room in house.rooms for file in files if file.startswith(room))
    assert len(sizes) == len(house.rooms)
    assert [room for room in sizes if sizes[room] > MOST] == list(LARGER[name])


def test_every_link_leads_somewhere() -> None:
    links = re.findall(r"\]\(([^)#]+)\)", TEXT)
    assert links
    assert [link for link in links if not (ROOT / link).exists()] == []


def test_every_file_of_a_recipe_is_there() -> None:
    recipes = TEXT.partition("## Recipes")[2].partition("\n## ")[0]
    named = set(re.findall(r"`((?:rust_core|python|docs|tests)/[\w./]+)`", recipes))
    assert len(named) > 15
    assert sorted(name for name in named if not (ROOT / name).exists()) == []
