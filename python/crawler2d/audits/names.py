"""What a file calls the wheels of a robot: names of its links by numbers of bodies."""

from __future__ import annotations

from crawler2d.parameters.robot import Robot
from crawler2d.reading.reading import Reading

__all__ = ["names_of"]


def names_of(robot: Robot, reading: Reading) -> dict[int, str]:
    """Return the left wheel of the file that each body stands for, by its number.

    Where a carrier has another number of wheels than the file, as one that stands on the roots of
    its flippers, its bodies have no names.
    """
    bodies, links = robot.wheels(), reading.wheels
    names: dict[int, str] = {}
    for carrier in ("chassis", "front flipper", "rear flipper"):
        here, there = (
            (table["side"] == "left") & (table["carrier"] == carrier) for table in (bodies, links)
        )
        if here.sum() == there.sum():
            own = sorted(zip(bodies["x"][here], bodies["body"][here], strict=True))
            named = sorted(zip(links["x"][there], links["name"][there], strict=True))
            names |= {int(body): str(name) for (_, body), (_, name) in zip(own, named, strict=True)}
    return names
