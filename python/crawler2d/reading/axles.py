"""The end axles of a robot and the outline of its track."""

from __future__ import annotations

import math

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.parameters.robot import TrackOutline
from crawler2d.reading.arms import ArmPair
from crawler2d.reading.belts import belt_round, ends_among
from crawler2d.reading.parts import Runner
from crawler2d.reading.sides import Pair, centers
from crawler2d.reading.sources import estimate, lines
from crawler2d.reading.telling import Telling, place_of
from crawler2d.reading.tracks import Base

__all__ = ["bent_round", "frame_of", "outline_of"]

_LARGEST = 3.0  # [m] The largest tracked robots that climb obstacles are shorter.


def bent_round(
    told: Telling,
    pairs: list[Pair],
    arms: list[ArmPair],
    castors: list[Runner],
    *,
    is_belt: bool,
) -> list[Pair]:
    """Return what the outline is the hull of, from the rear to the front; note its lines.

    The two outermost wheels, or the drums that a belt bends round; without either, the roots of
    flippers; of a robot with one wheel a side, that and its castors.

    Raises
    ------
    ScenarioError
        If there is nothing to stand on at one end, or something reaches out of a belt.
    """
    if is_belt:
        bent = belt_round(pairs, at=told.at)
    elif len(pairs) == 1 and castors:
        # One wheel a side is no track: the robot stands on it and on what it trails.
        bent = sorted([*pairs, *map(_alone, castors)], key=lambda pair: pair.x)
        reason = "is no track: its outline is drawn round it and the free wheels in the middle"
        told.doubts.append(("robot.outline", "one wheel a side", reason))
    elif pairs:
        bent = [pairs[0], pairs[-1]]
    else:
        # Nothing runs between the flippers: the robot stands on their roots.
        order = sorted(arms, key=lambda arm: float(arm.pivot[0]))
        if len(order) < 2:
            rule = "must have wheels on the chassis, or flippers at both ends"
            raise ScenarioError(str(told.at), "flippers at one end", rule)
        bent = [order[0].pairs[0], order[-1].pairs[0]]
        text = "the chassis has no wheels: it stands on the roots of its flippers"
        told.notes.append(text)
        told.note("robot.track", estimate(f"{text}, which are no track"))
    runners = [runner for pair in bent for runner in pair.both]
    places = [place_of(runner) for runner in runners]
    if len(bent) > 2:
        sizes = [runner.shape.size_at for runner in runners]
        told.note("robot.outline.discs", lines([*places, *sizes]))
    else:
        told.note("robot.outline.axle_distance", lines(places))
        for name, pair in zip(("rear_radius", "front_radius"), bent, strict=True):
            told.note(f"robot.outline.{name}", lines([r.shape.size_at for r in pair.both]))
    if pairs:
        of_all = [s.size_at for pair in pairs for runner in pair.both for s in runner.surfaces]
        told.note("robot.track", lines(of_all, "sizes"))
    return bent


def _alone(castor: Runner) -> Pair:
    return Pair(left=(castor,), right=(castor,), x=castor.x, y=castor.y, radius=castor.radius)


def frame_of(told: Telling, bent: list[Pair], tolerance: float) -> tuple[Base, Pair]:
    """Return the chassis frame, and what is on the rear end axle.

    Raises
    ------
    ScenarioError
        If there is no distance between the two.
    """
    rear, front = bent if len(bent) == 2 else ends_among(bent)
    base = Base(
        rear=np.array([rear.x, rear.y]),
        front=np.array([front.x, front.y]),
        is_level=len(bent) > 2,
    )
    if base.length <= tolerance:
        rule = "must have two wheels or drums on each side"
        raise ScenarioError(str(told.at), base.length, rule)
    return base, rear


def outline_of(told: Telling, base: Base, bent: list[Pair]) -> TrackOutline:
    """Return the outline, without grousers, which no format has."""
    for name in ("grouser_height", "grouser_pitch", "grouser_thickness"):
        told.note(f"robot.outline.{name}", estimate("the file has no grousers"))
    radii = [pair.radius for pair in bent]
    grousers = {
        "grouser_height": 0.0,
        "grouser_pitch": 0.75 * min(radii),
        "grouser_thickness": 0.0,
    }
    if len(bent) == 2:
        rear, front = radii
        outline = TrackOutline(
            axle_distance=base.length, front_radius=front, rear_radius=rear, **grousers
        )
    else:
        places = base.of(centers(bent))
        outline = TrackOutline(discs=np.column_stack([places, radii]), **grousers)
    length = outline.axle_distance
    whole = length + outline.rear_radius + outline.front_radius
    if whole > _LARGEST:
        power = math.ceil(math.log10(whole / _LARGEST))
        reason = (
            f"is usually at most {_LARGEST:g} m with the wheels: is the file in metres?"
            f" scale={10.0**-power:g} reads it so much smaller"
        )
        told.doubts.append(("robot.outline.axle_distance", length, reason))
    return outline
