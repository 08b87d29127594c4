"""Model files with faults: shipped and written ones, with bytes, numbers, tags, lines changed."""

from __future__ import annotations

import dataclasses
import random
import re
from collections.abc import Callable, Sequence
from pathlib import Path

import crawler2d as c2d
from crawler2d.common.ends import Disc
from crawler2d.parameters.track import Track
from tests.robots.robot_files import FOLDER

CARTS = Path(__file__).parent.parent / "reading" / "files"


def _written(track: Track, form: str, discs: Sequence[Disc] | None = None) -> bytes:
    """A robot as a model file, without the comment in it, which nobody reads."""
    robot = c2d.robots.engineer(track=track)
    if discs is not None:
        outline = c2d.TrackOutline(
            discs=discs, grouser_height=0.0, grouser_pitch=0.05, grouser_thickness=0.0
        )
        robot = dataclasses.replace(robot, outline=outline)
    text: str = getattr(robot, f"to_{form}")()
    return re.sub("<!--.*?-->", "", text, flags=re.DOTALL).encode()


GEARS = c2d.LineOfWheels(3, wheel=c2d.GearWheel(grouser_count=6))
TAPERED = c2d.LineOfWheels(2, wheel=c2d.GearWheel(grouser_count=5, base_thickness=0.012))
TRIANGLE = ((-0.18, 0.0, 0.064), (0.18, 0.0, 0.064), (0.25, 0.1, 0.05))

ORIGINALS: dict[str, bytes] = {
    **{
        path.name: path.read_bytes()
        for path in (
            FOLDER / "absolem.sdf",
            FOLDER / "marv.sdf",
            FOLDER / "tracked_vehicle_simple.sdf",
            FOLDER / "eng.urdf",
            CARTS / "cart.sdf",
            CARTS / "cart.urdf",
        )
    },
    "belt.sdf": _written(c2d.BeltTrack(), "sdf", TRIANGLE),
    "gears.sdf": _written(GEARS, "sdf"),
    "gears.urdf": _written(GEARS, "urdf"),
}
"""By name; of the small ones, a fault hits what matters more often."""

MJCF = {
    "cart.xml": (CARTS / "cart.xml").read_bytes(),
    "belt.xml": _written(c2d.BeltTrack(), "mjcf", TRIANGLE),
    "gears.xml": _written(GEARS, "mjcf"),
    "tapered.xml": _written(TAPERED, "mjcf"),
}
XACRO = {path.name: path.read_bytes() for path in (FOLDER / "eng.xacro", CARTS / "cart.xacro")}

NUMBERS = (
    *b"nan inf -inf 1e999 -1 0 -0.0 1e-320 1e300 999999 0x10 1_0 1,5 -1e6 3.1415".split(),
    *("\u0661".encode(), b"", b"1 2", b"9" * 70, b"1e-9"),
)

_NUMBER = re.compile(rb"-?\d+\.?\d*(?:e[+-]?\d+)?")
_TAG = re.compile(rb"</?[A-Za-z_:]+")
_WORD = re.compile(rb"(?<=[>\"'])[A-Za-z_]\w+(?=[<\"'])")

Fault = Callable[[bytes, random.Random], bytes]


def mutated(data: bytes, draw: random.Random) -> bytes:
    """Put one to four faults into a file."""
    for _ in range(draw.choice((1, 1, 2, 4))):
        data = draw.choice(_FAULTS)(data, draw)
    return data


def _of_a_byte(data: bytes, draw: random.Random) -> bytes:
    where = draw.randrange(len(data) + 1)
    return data[:where] + bytes([draw.randrange(256)]) + data[where + draw.randrange(2) :]


def _of_a_number(data: bytes, draw: random.Random) -> bytes:
    return _swapped(_NUMBER, data, draw, draw.choice(NUMBERS))


def _of_a_tag(data: bytes, draw: random.Random) -> bytes:
    tags = _TAG.findall(data)
    return _swapped(_TAG, data, draw, draw.choice(tags)) if tags else data


def _of_a_name(data: bytes, draw: random.Random) -> bytes:
    words = _WORD.findall(data)
    return _swapped(_WORD, data, draw, draw.choice(words)) if words else data


def _swapped(pattern: re.Pattern[bytes], data: bytes, draw: random.Random, new: bytes) -> bytes:
    found = list(pattern.finditer(data))
    if not found:
        return data
    spot = draw.choice(found)
    return data[: spot.start()] + new + data[spot.end() :]


def _without_lines(data: bytes, draw: random.Random) -> bytes:
    lines = data.split(b"\n")
    first = draw.randrange(len(lines))
    return b"\n".join(lines[:first] + lines[first + draw.choice((1, 1, 3, 30)) :])


def _with_lines_twice(data: bytes, draw: random.Random) -> bytes:
    lines = data.split(b"\n")
    first = draw.randrange(len(lines))
    some = lines[first : first + draw.choice((1, 5, 60))]
    return b"\n".join(lines[:first] + some * draw.choice((2, 2, 2, 50)) + lines[first:])


def _cut_short(data: bytes, draw: random.Random) -> bytes:
    return data[: draw.randrange(len(data) + 1)]


_FAULTS: tuple[Fault, ...] = (
    _of_a_byte,
    _of_a_number,
    _of_a_number,
    _of_a_tag,
    _of_a_name,
    _without_lines,
    _with_lines_twice,
    _cut_short,
)
