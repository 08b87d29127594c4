"""What a fuzzer that is guided by coverage calls in the package: files and stores, made of bytes.

Each target is read, or is refused by an error that is documented; anything else is a fault.
"""

from __future__ import annotations

import sqlite3
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import crawler2d as c2d
from tests.fuzz.model_files import PARTS
from tests.sweeps.stores import change, opened, read, sound
from tests.sweeps.test_store_damaged import COLUMNS, PAGE, found_in, joined

Target = Callable[[bytes, Path], None]


def model(data: bytes, folder: Path) -> None:
    """Read bytes as SDF or URDF."""
    read_robot(folder / ("case.sdf" if b"<sdf" in data[:1000] else "case.urdf"), data)


def xacro(data: bytes, folder: Path) -> None:
    """Read bytes as xacro."""
    read_robot(folder / "case.xacro", data, missing="leave_out")


def mjcf(data: bytes, folder: Path) -> None:
    """Read bytes as MJCF."""
    read_robot(folder / "case.xml", data)


def read_robot(path: Path, data: bytes, **how: Any) -> None:
    path.write_bytes(data)
    try:
        reading = c2d.read_robot(path, mesh="leave_out", **how)
    except c2d.ScenarioError as error:
        if not error.path:
            raise AssertionError("refused without a path") from error
    else:
        assert reading.robot.wheels() is not None


def store(data: bytes, folder: Path) -> None:
    """Damage a store as bytes say; without right checksums it is refused, or reads as it was."""
    draw = Draw(data)
    original, path = folder / "original.sqlite", folder / "case.sqlite"
    whole = read(original)
    path.write_bytes(original.read_bytes())
    is_checked = False
    for _ in range(draw.below(5)):
        if draw.below(2):
            damage_a_text(path, draw)
            is_checked = True
            continue
        content = bytearray(path.read_bytes())
        damage_bytes(content, draw)
        path.write_bytes(content)
    damaged = path.read_bytes()
    for way in (c2d.check_store, read, found_in, joined):
        path.write_bytes(damaged)
        try:
            found = way(path)
        except c2d.StoreError:
            continue
        assert is_checked or way is c2d.check_store or found == whole, way.__name__


class Draw:
    """Numbers and texts from bytes, and zeros after their end."""

    def __init__(self, data: bytes) -> None:
        self.data = data

    def take(self, count: int) -> bytes:
        taken, self.data = self.data[:count], self.data[count:]
        return taken

    def below(self, count: int) -> int:
        return int.from_bytes(self.take(1 + (count > 256) + (count > 65536))) % count


def damage_bytes(content: bytearray, draw: Draw) -> None:
    """Change a byte or some, a page, or the length."""
    if not content:
        return
    pages = max(1, len(content) // PAGE)
    kind, page = draw.below(6), PAGE * draw.below(pages)
    match kind:
        case 0:
            content[page : page + PAGE] = bytes(PAGE)
        case 1:
            other = PAGE * draw.below(pages)
            content[page : page + PAGE] = content[other : other + PAGE]
        case 2:
            del content[max(1, page + draw.below(PAGE)) :]
        case 3:  # the beginning of a page describes its content
            content[min(page + draw.below(128), len(content) - 1)] = draw.below(256)
        case _:
            at = page + draw.below(PAGE)
            new = draw.take(1 + draw.below(8))
            content[at : at + len(new)] = new


def damage_a_text(path: Path, draw: Draw) -> None:
    """Change a column of a row, and write the checksum that belongs to it."""
    name, number = COLUMNS[draw.below(len(COLUMNS) - 1)], 1 + draw.below(5)
    begin, length, new = draw.below(4096), draw.below(64), draw.take(draw.below(32))
    try:
        with opened(path) as connection:
            (text,) = connection.execute(
                f"SELECT CAST({name} AS TEXT) FROM run WHERE rowid = ?", (number,)
            ).fetchone()
        text = "" if text is None else text
        begin %= len(text) + 1
        text = text[:begin] + new.decode(errors="replace") + text[begin + length :]
        change(path, number, **{name: text})
    except (sqlite3.Error, TypeError, ValueError):
        return  # a damaged store may be impossible to change


TARGETS: dict[str, Target] = {"model": model, "xacro": xacro, "mjcf": mjcf, "store": store}


def prepare(name: str, folder: Path) -> None:
    """Put the files that the cases of a target name into a folder."""
    warnings.simplefilter("ignore", c2d.ScenarioWarning)
    if name == "store":
        sound(folder / "original.sqlite", repeats=1)
        return
    for part, data in PARTS.items():
        (folder / part).parent.mkdir(parents=True, exist_ok=True)
        (folder / part).write_bytes(data)
