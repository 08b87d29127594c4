"""A robot that is known to seize, as an object and as a file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import crawler2d as c2d
from tests.reading.carts import collision, pair, urdf

SEIZING = c2d.robots.engineer(
    flippers=None, track=c2d.LineOfWheels(4, wheel_radius=0.0608)
).without_rotors()
"""Four wheels that touch; as in the file below, their motors have no rotors."""

STEP: Any = {"step of 75 mm": c2d.terrains.step(0.075)}
"""Where it seizes."""

QUIET: Any = {"progress": False}

SAID = Path(__file__).with_name("said.txt")


def seizing_file(name: str = "cart", wheels: str = "") -> str:
    """Write a cart that seizes there as URDF, with given names for robot and wheels."""
    places = {"front": 0.1825, "fore": 0.060833, "aft": -0.060833, "rear": -0.1825}
    pairs = [pair(f"{each}{wheels}", x, radius="0.0608") for each, x in places.items()]
    box = collision('<box size="0.3 0.1 0.05"/>', '<origin xyz="0 0 0.05"/>')
    return urdf(*pairs, shapes=box).replace('name="cart"', f'name="{name}"')


def instant_audit(found: c2d.Audit) -> Any:
    """An audit that takes no time and prints its result."""

    def audit(*_: Any, progress: Any, **__: Any) -> c2d.Audit:
        progress.print(found.summary)
        return found

    return audit
