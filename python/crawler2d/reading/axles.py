"""The end axles of a robot and the outline of its track."""

from __future__ import annotations

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.parameters.robot import TrackOutline
from crawler2d.reading.arms import ArmPair
from crawler2d.reading.belts import belt_ends
from crawler2d.reading.parts import Gear
from crawler2d.reading.sides import Pair
from crawler2d.reading.sources import estimate, lines
from crawler2d.reading.telling import Telling, place_of
from crawler2d.reading.tracks import Base

__all__ = ["end_axles", "outline_of"]

_LARGEST = 3.0  # [m] The largest tracked robots that climb obstacles are shorter.


def end_axles(
    told: Telling, gear: Gear, pairs: list[Pair], arms: list[ArmPair], *, is_belt: bool
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """[m] Return x, y and radius of the rear and the front axle; note their lines."""
    names = "axle_distance", "rear_radius", "front_radius"
    if pairs:
        rear, front = pairs[0], pairs[-1]
        if is_belt:
            rear, front = belt_ends(pairs, gear.bars, along=np.array([1.0, 0.0]), at=told.at)
        found = rear, front
    else:
        # Nothing runs between the flippers: the robot stands on their roots.
        order = sorted(arms, key=lambda arm: float(arm.pivot[0]))
        if len(order) < 2:
            rule = "must have wheels on the chassis, or flippers at both ends"
            raise ScenarioError(str(told.at), "flippers at one end", rule)
        found = order[0].pairs[0], order[-1].pairs[0]
        text = "the chassis has no wheels: it stands on the roots of its flippers"
        told.notes.append(text)
        told.note("robot.track", estimate(f"{text}, which are no track"))
    rear, front = found
    both = [*rear.both, *front.both]
    places = [place_of(runner) for runner in both]
    for name, where in zip(
        names,
        (places, [r.shape.size_at for r in rear.both], [r.shape.size_at for r in front.both]),
        strict=True,
    ):
        told.note(f"robot.outline.{name}", lines(where))
    if pairs:
        of_all = [runner.shape.size_at for pair in pairs for runner in pair.both]
        told.note("robot.track", lines(of_all, "radii"))
    return (rear.x, rear.y, rear.radius), (front.x, front.y, front.radius)


def outline_of(told: Telling, base: Base, rear: float, front: float) -> TrackOutline:
    """Return the outline, without grousers, which no format has."""
    for name in ("grouser_height", "grouser_pitch", "grouser_thickness"):
        told.note(f"robot.outline.{name}", estimate("the file has no grousers"))
    if base.length + rear + front > _LARGEST:
        reason = f"is usually at most {_LARGEST:g} m with the wheels: is the file in metres?"
        told.doubts.append(("robot.outline.axle_distance", base.length, reason))
    return TrackOutline(
        axle_distance=base.length,
        front_radius=front,
        rear_radius=rear,
        grouser_height=0.0,
        grouser_pitch=0.75 * min(front, rear),
        grouser_thickness=0.0,
    )
