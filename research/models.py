"""The robots and track models of the studies, each with its source in the paper."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Literal, NamedTuple

import crawler2d as c2d
from crawler2d.parameters.terrain import Barrier, Step
from crawler2d.parameters.track import Track
from research.paper import CWA_GEAR, CWA_ROUND, LWA_GEAR, LWA_ROUND

FRICTION = 0.9
"""[-] Friction between track and ground: an estimate, like those of the robot."""


def study_robot(flippers: c2d.Flippers | Literal["built"] | None = None, **parts: Any) -> c2d.Robot:
    """Make the robot of the studies: the Engineer without rotors, like models for simulators.

    Parameters
    ----------
    flippers, **parts
        See `engineer`; by default it has no flippers.
    """
    return c2d.robots.engineer(flippers=flippers, **parts).without_rotors()


def study_robots() -> dict[str, c2d.Robot]:
    """List the robot of the seizure study, and variants that test its estimates.

    The centre of mass moves up with a raised arm, and forward with an arm or flippers stretched
    out. The belly hangs lower, or is removed. The motors are twice as strong: a gear wheel that
    hooks into an edge needs more torque than a round one that slides on it.
    """
    base = study_robot()
    strong = replace(base.drivetrain, max_torque=2.0 * base.drivetrain.max_torque)
    return {
        "preset": base,
        "mass 20 mm up": study_robot(center_of_mass=(0.0, 0.04)),
        "mass 30 mm forward": study_robot(center_of_mass=(0.03, 0.02)),
        "belly at 20 mm": study_robot(belly_clearance=0.020),
        "no belly": replace(base, belly=None),
        "torque doubled": replace(base, drivetrain=strong),
    }


def obstacle(name: str, height: float, friction: float = FRICTION) -> Step | Barrier:
    """Make an obstacle: a "step", a "barrier" 100 mm thick, or a "knife edge" of 10 mm."""
    if name == "step":
        return c2d.terrains.step(height, friction=friction)
    thickness = {"barrier": 0.1, "knife edge": 0.01}[name]
    return c2d.terrains.barrier(height, thickness, friction=friction)


class StudyModel(NamedTuple):
    """A track model and where it comes from."""

    track: Track
    source: str
    """Figure or section of the paper, or "ours"."""
    row: str | None = None
    """The row of the paper's Table 3 with this kind of model; None if there is none."""
    arms: Track | None = None
    """The track of the flippers; None takes the model of the robot."""

    def on(self, robot: c2d.Robot) -> c2d.Robot:
        """Put it on a robot, and on its flippers if it has any."""
        arms = None if robot.flippers is None else replace(robot.flippers, track=self.arms)
        return replace(robot, track=self.track, flippers=arms)


def study_models() -> dict[str, StudyModel]:
    """List the track models of the study by name, in the order of the tables.

    Wheels that touch on the robot, or are placed by hand, do not fit a tapering arm. There they are
    replaced by a line of four wheels, about the number that touch.

    Examples
    --------
    >>> study_models()["line of 3"].source
    'Fig. 3'
    """
    line, around, gear = c2d.LineOfWheels, c2d.CircumferentialWheels, c2d.GearWheel()
    axle_distance = study_robot().outline.axle_distance
    touching = axle_distance / 6.0  # the radius of wheels in a line of four
    end, low = 0.5 * axle_distance, -0.034
    small = [(x, low, 0.03) for x in (-0.07, 0.0, 0.07)]
    hybrid = ((-end, 0.0, 0.064), *small, (end, 0.0, 0.064))
    four, four_touching = line(4), line(4, wheel_radius=touching)
    return {
        "belt": StudyModel(c2d.BeltTrack(), "ours"),
        "belt with grousers": StudyModel(c2d.GrouserBeltTrack(), "ours"),
        "chain of 22 shoes": StudyModel(c2d.SegmentalTrack(shoe_count=22), "2.3, Figs. 9, 10"),
        "force on skids": StudyModel(c2d.ForceTrack(), "2.1"),
        "force on wheels": StudyModel(c2d.ForceTrack(support="wheels"), "2.1"),
        "line of 3": StudyModel(line(3), "Fig. 3", LWA_ROUND),
        "line of 4, touching": StudyModel(four_touching, "Fig. 2", LWA_ROUND, four),
        "line of 5": StudyModel(line(5), "Fig. 1", LWA_ROUND),
        "line of 9": StudyModel(line(9), "Fig. 1", LWA_ROUND),
        "line of 3 gears": StudyModel(line(3, wheel=gear), "Figs. 11, 13", LWA_GEAR),
        "line of 5 gears": StudyModel(line(5, wheel=gear), "Figs. 11, 13", LWA_GEAR),
        "24 all round": StudyModel(around(24), "Figs. 5, 6", CWA_ROUND),
        "24 gears all round": StudyModel(around(24, wheel=gear), "Fig. 12", CWA_GEAR),
        "16 all round, spaced": StudyModel(around(16, wheel_radius=0.02), "Fig. 7", CWA_ROUND),
        "hybrid": StudyModel(c2d.HybridWheels(hybrid), "Fig. 8", arms=four),
        "hybrid gears": StudyModel(
            c2d.HybridWheels(hybrid, wheel=gear), "ours", arms=line(4, wheel=gear)
        ),
    }


def gear_pairs(models: Mapping[str, StudyModel]) -> dict[str, str]:
    """Pair each model with gear wheels with the same model with round wheels.

    Parameters
    ----------
    models : mapping of str to StudyModel
        Models by name.

    Returns
    -------
    dict of str to str
        From the name of each model with gear wheels to that with round ones.

    Examples
    --------
    >>> gear_pairs(study_models())["line of 3 gears"]
    'line of 3'
    """
    names = {model.track: name for name, model in models.items()}
    pairs = {}
    for name, model in models.items():
        track = model.track
        if isinstance(track, (c2d.LineOfWheels, c2d.CircumferentialWheels, c2d.HybridWheels)):
            twin = names.get(replace(track, wheel=c2d.RoundWheel()))
            if isinstance(track.wheel, c2d.GearWheel) and twin is not None:
                pairs[name] = twin
    return pairs
