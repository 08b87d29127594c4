"""The rooms of docs/rooms.toml, and violations of their rules."""

import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
LIST = "docs/rooms.toml"


@dataclass(frozen=True)
class Import:
    """One file of a house imports another; paths from the folder of the house, with slashes."""

    file: str
    line: int
    imported: str


@dataclass(frozen=True)
class House:
    """Rooms from the ground up: folders, whose names end with a slash, and single files."""

    folder: Path
    rooms: Sequence[str]
    circles: str
    """Where files may import each other in a circle: "nowhere" or "inside a room"."""

    @staticmethod
    def read(name: str) -> "House":
        """Read that of the core or of the package."""
        listed: Mapping[str, Any] = tomllib.loads((ROOT / LIST).read_text(encoding="utf-8"))[name]
        return House(ROOT / listed["folder"], listed["rooms"], listed["circles"])

    def floor(self, file: str) -> int | None:
        """Return the index of the room of a file."""
        for index, room in enumerate(self.rooms):
            if file == room or (room.endswith("/") and file.startswith(room)):
                return index
        return None


def violations(house: House, files: Iterable[str], imports: Sequence[Import]) -> Iterator[str]:
    """List violations: files without a room, rooms without files, imports from above, circles."""
    files = sorted(files)
    floors = {file: house.floor(file) for file in files}
    for file, floor in floors.items():
        if floor is None:
            yield f"{place(house, file)}: lies in no room of {LIST}"
    for index, room in enumerate(house.rooms):
        if index not in floors.values():
            yield f"{place(house, room)}: {LIST} lists this room, but no file lies there"
    for each in imports:
        here, there = floors.get(each.file), floors.get(each.imported)
        if here is not None and there is not None and there > here:
            yield (
                f"{place(house, each.file)}:{each.line}: imports {each.imported}, but"
                f" {house.rooms[here]} must not know {house.rooms[there]}, which {LIST} lists later"
            )
    edges = {each.file: set[str]() for each in imports}
    for each in imports:
        if house.circles == "nowhere" or floors.get(each.file) != floors.get(each.imported):
            edges[each.file].add(each.imported)
    lines = {(each.file, each.imported): each.line for each in reversed(imports)}
    for circle in circles(edges):
        file, then = circle[0], circle[1 % len(circle)]
        way = " -> ".join([*circle, file])
        yield (
            f"{place(house, file)}:{lines[file, then]}: imports {then}, which leads back to it:"
            f" {way}; files may import each other in a circle {house.circles}"
        )


def place(house: House, name: str) -> str:
    """Write the path of a file or room, relative to the root of the project if it is inside."""
    folder = house.folder.relative_to(ROOT) if ROOT in house.folder.parents else house.folder
    return f"{folder.as_posix()}/{name}"


def circles(edges: Mapping[str, set[str]]) -> Iterator[list[str]]:
    """Yield one short circle for each group of files that import each other."""
    seen: set[str] = set()
    for start in sorted(edges):
        if start in seen:
            continue
        way = _way_round(start, edges)
        if way:
            seen |= _reached(start, edges) & {
                other for other in edges if start in _reached(other, edges)
            }
            yield way


def _reached(start: str, edges: Mapping[str, set[str]]) -> set[str]:
    found: set[str] = set()
    left = [start]
    while left:
        new = edges.get(left.pop(), set()) - found
        found |= new
        left.extend(new)
    return found


def _way_round(start: str, edges: Mapping[str, set[str]]) -> list[str]:
    """Find a shortest circle from a file to itself; empty if there is none."""
    ways = [[start]]
    seen: set[str] = set()
    for way in ways:
        for then in sorted(edges.get(way[-1], set()) - seen):
            if then == start:
                return way
            seen.add(then)
            ways.append([*way, then])
    return []
