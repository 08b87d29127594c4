"""The kinds of robot in the study: track model, motors, flippers; the Engineer throughout."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

import crawler2d as c2d
from benches.accuracy.grounds import ONE_LANE, TWO_LANES
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.track import Track

# [m] Axle distance of the Engineer; in a line of four, wheels of a sixth of it touch.
_AXLES = 0.365
_GEAR = c2d.GearWheel()

_SUPPORTS: tuple[Literal["skids", "wheels"], ...] = ("skids", "wheels")
_MECHANISMS: tuple[Literal["guide", "sprocket"], ...] = ("guide", "sprocket")
_GAITS: tuple[Literal["climb", "hold"], ...] = ("climb", "hold")

Ends = Literal["front", "rear", "both"]
_ENDS: dict[Ends, str] = {"front": "in front", "rear": "behind", "both": "at both ends"}


@dataclass(frozen=True, kw_only=True)
class Kind:
    """A kind of robot, of which cells are drawn."""

    name: str
    model: str
    """Kinds of one model are judged together."""
    track: Track
    sharing: Literal["track", "wheel"] = "track"
    """Whether a track has one motor or each wheel a servo."""
    ends: Ends | None = None
    """Where flippers are."""
    gait: Literal["climb", "hold"] | None = None
    obstacles: tuple[str, ...] = ONE_LANE
    heights: tuple[float, float] = (0.01, 0.3)
    """[m] Between these the search takes place."""

    def robot(self, center_of_mass: tuple[float, float], max_torque: float) -> Robot:
        """Build the robot.

        Parameters
        ----------
        center_of_mass : (float, float)
            [m] Without flippers.
        max_torque : float
            [N m] Of one sprocket.
        """
        arms = c2d.robots.engineer().flippers if self.ends else None
        if arms is not None and self.ends is not None:
            arms = replace(arms, ends=self.ends)
        robot = c2d.robots.engineer(center_of_mass=center_of_mass, flippers=arms, track=self.track)
        drivetrain = replace(robot.drivetrain, max_torque=max_torque, torque_sharing=self.sharing)
        return replace(robot, drivetrain=drivetrain).without_rotors()


def _lines() -> Iterator[Kind]:
    for wheel, word in ((c2d.RoundWheel(), "round"), (_GEAR, "gears")):
        for count in (3, 4, 5, 9):
            radius = _AXLES / 6.0 if count == 4 else None
            track = c2d.LineOfWheels(count, wheel_radius=radius, wheel=wheel)
            name = f"line of {count} {word}"
            model = f"lines of {'gear' if word == 'gears' else 'round'} wheels"
            yield Kind(name=name, model=model, track=track)
            yield Kind(name=f"{name}, servos", model=model, track=track, sharing="wheel")


def _closed() -> Iterator[Kind]:
    small = c2d.CircumferentialWheels(24)
    low = -0.034
    middle = tuple((x, low, 0.03) for x in (-0.07, 0.0, 0.07))
    ends = ((-0.5 * _AXLES, 0.0, 0.064), (0.5 * _AXLES, 0.0, 0.064))
    hybrid = c2d.HybridWheels((ends[0], *middle, ends[1]))
    tracks: dict[str, Track] = {
        "24 round all round": small,
        "24 gears all round": replace(small, wheel=_GEAR),
        "belt": c2d.BeltTrack(),
        "belt with grousers": c2d.GrouserBeltTrack(),
    }
    for letter in "ab":
        for name, track in tracks.items():
            yield Kind(name=f"{name} ({letter})", model=name, track=track)
    yield Kind(name="hybrid round", model="hybrid", track=hybrid)
    yield Kind(name="hybrid gears", model="hybrid", track=replace(hybrid, wheel=_GEAR))
    for support in _SUPPORTS:
        yield Kind(
            name=f"force on {support}",
            model="force",
            track=c2d.ForceTrack(support=support),
            heights=(0.003, 0.2),
        )


def _lanes() -> Iterator[Kind]:
    tracks: dict[str, Track] = {
        "belt": c2d.BeltTrack(),
        "line of 5 round": c2d.LineOfWheels(5),
        "line of 3 gears": c2d.LineOfWheels(3, wheel=_GEAR),
        "belt with grousers": c2d.GrouserBeltTrack(),
        "24 gears all round": c2d.CircumferentialWheels(24, wheel=_GEAR),
    }
    for name, track in tracks.items():
        yield Kind(
            name=f"{name}, two lanes",
            model="two lanes",
            track=track,
            obstacles=TWO_LANES,
        )


def _chains() -> Iterator[Kind]:
    for count in (22, 44):
        for mechanism in _MECHANISMS:
            yield Kind(
                name=f"chain of {count}, {mechanism}",
                model="chains",
                track=c2d.SegmentalTrack(shoe_count=count, mechanism=mechanism),
            )


def _arms() -> Iterator[Kind]:
    tracks: dict[str, Track] = {
        "belt": c2d.BeltTrack(),
        "line of 5 round": c2d.LineOfWheels(5),
        "line of 3 gears": c2d.LineOfWheels(3, wheel=_GEAR),
    }
    for name, track in tracks.items():
        for ends, place in _ENDS.items():
            for gait in _GAITS:
                yield Kind(
                    name=f"{name}, flippers {place}, {gait}",
                    model=f"{name}, flippers",
                    track=track,
                    ends=ends,
                    gait=gait,
                    heights=(0.03, 0.45),
                )


KINDS = {kind.name: kind for part in (_lines, _closed, _lanes, _chains, _arms) for kind in part()}
"""All kinds by name, those that cost little first."""
