"""Common parts of tests: scenarios that cover every variant, and the length of tests."""

import dataclasses
import os
from collections.abc import Callable
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.track import Track

SOAK = "CRAWLER2D_SOAK" in os.environ
"""Set by make soak: a hundred times the cases."""

NO_DASK = "import sys; sys.modules['dask'] = None\n"
"""Begins programs that make tables: xarray would import it, and that takes longest."""

ROBOT = c2d.robots.engineer(flippers=None).without_rotors()
"""Without rotors, which rapier does not hold: jams are those of its tracks alone."""
TRAPEZOID = dataclasses.replace(
    ROBOT,
    outline=dataclasses.replace(
        ROBOT.outline,
        discs=((-0.28, 0.09, 0.05), (-0.17, 0.0, 0.064), (0.17, 0.0, 0.064), (0.29, 0.1, 0.045)),
    ),
)
"""The same with a raised sprocket and a raised idler."""
POINTS = [[-3.0, 0.0], [0.0, 0.0], [0.0, 0.05], [3.0, 0.05]]
PLACEMENTS: Any = [[-0.1875, 0.0, 0.0625], [0.0, -0.03125, 0.03125], [0.1875, 0.0, 0.0625]]
GEAR = c2d.GearWheel(
    grouser_count=9,
    grouser_height=0.005,
    tip_thickness=0.003,
    base_thickness=0.005,
    phase_fraction=0.5,
)


def refused(call: Any) -> c2d.ScenarioError:
    """The error of a refused call, whose rule begins with "must"."""
    with pytest.raises(c2d.ScenarioError) as caught:
        call()
    assert caught.value.rule.startswith("must")
    return caught.value


def with_flippers(track: Track, arms: Track | None = None, ends: Any = "both") -> c2d.Robot:
    """Give the robot raised flippers, with their own track model if `arms` is one."""
    built = c2d.robots.engineer().flippers
    assert built is not None
    flippers = dataclasses.replace(built, ends=ends, track=arms)
    return c2d.robots.engineer(flippers=flippers, track=track)


VARIANTS = {
    "belt-step": Scenario(ROBOT, c2d.terrains.step(0.05, edge_radius=0.01)),
    "belt-on-discs-step": Scenario(TRAPEZOID, c2d.terrains.step(0.05)),
    "wheels-on-discs-ridge": Scenario(
        TRAPEZOID.with_track(c2d.CircumferentialWheels(40, wheel=c2d.GearWheel())),
        c2d.terrains.ridge(0.03, 1.5),
    ),
    "line-flat": Scenario(
        ROBOT.with_track(c2d.LineOfWheels(4, wheel_radius=0.06)), c2d.terrains.flat(), goal=1.0
    ),
    "force-ramp": Scenario(ROBOT.with_track(c2d.ForceTrack()), c2d.terrains.ramp(0.2)),
    "belt-points": Scenario(ROBOT, c2d.terrains.from_points(POINTS, goal=0.0)),
    "belt-lanes": Scenario(
        ROBOT,
        c2d.terrains.lanes(
            c2d.terrains.step(0.05), c2d.terrains.step(0.05), middle=c2d.terrains.step(0.05)
        ),
    ),
    "gears-diagonal-barrier": Scenario(
        ROBOT.with_track(c2d.LineOfWheels(3, wheel=GEAR)),
        c2d.terrains.diagonal_barrier(0.4, height=0.04, thickness=0.05, edge_radius=0.004),
    ),
    "line-stepfield": Scenario(
        ROBOT.with_track(c2d.LineOfWheels(5)),
        c2d.terrains.stepfield_with_barrier(
            3, height=0.05, thickness=0.05, yaw=0.3, rise=0.01, edge_radius=0.002
        ),
    ),
    "grousers-gap": Scenario(
        ROBOT.with_track(c2d.GrouserBeltTrack(grouser_count=20)),
        c2d.terrains.gap(0.08, edge_radius=0.003),
    ),
    "segmental-step": Scenario(
        ROBOT.with_track(
            c2d.SegmentalTrack(
                shoe_count=30, shoe_shape="trapezoid", plate_thickness=0.002, pre_tension=4.0
            )
        ),
        c2d.terrains.step(0.04),
    ),
    "flippers-climb": Scenario(
        c2d.robots.engineer(track=c2d.BeltTrack()),
        c2d.terrains.step(0.06, edge_radius=0.002),
        drive=c2d.Drive(schedule=((1.0, 0.2), (2.0, 0.4)), gait=c2d.Climb()),
    ),
    "flippers-hold": Scenario(
        c2d.robots.absolem(track="public"),
        c2d.terrains.flat(),
        drive=c2d.Drive(gait=c2d.Hold(0.5, ((0.5, -0.2),))),
    ),
    "sprocket-step": Scenario(
        ROBOT.with_track(
            c2d.SegmentalTrack(
                mechanism="sprocket",
                tensioner_stiffness=900.0,
                tensioner_damping=60.0,
                pin_stiffness=0.05,
                pin_damping=0.002,
                road_wheel_count=6,
                return_roller_count=2,
            )
        ),
        c2d.terrains.step(0.04),
    ),
    "line-barrier": Scenario(
        ROBOT.with_track(c2d.LineOfWheels(3, wheel=GEAR)),
        c2d.terrains.barrier(0.05, 0.03, edge_radius=0.005),
    ),
    "circumferential-ridge": Scenario(
        ROBOT.with_track(c2d.CircumferentialWheels(24, wheel_radius=0.015)),
        c2d.terrains.ridge(0.05, 1.0, edge_radius=0.005),
    ),
    "circumferential-half-round": Scenario(
        ROBOT.with_track(c2d.CircumferentialWheels(24, wheel=c2d.GearWheel())),
        c2d.terrains.half_round(0.05),
        solver=c2d.Solver(time_step=1e-3),
    ),
    "hybrid-gap": Scenario(
        ROBOT.with_track(c2d.HybridWheels(PLACEMENTS)), c2d.terrains.gap(0.1, edge_radius=0.005)
    ),
    "closed-barrier": Scenario(
        ROBOT.with_track(c2d.ClosedTrack(c2d.LineOfWheels(4, wheel=GEAR))),
        c2d.terrains.barrier(0.06, 0.08),
    ),
    "force-stairs": Scenario(
        ROBOT.with_track(c2d.ForceTrack(support="wheels")),
        c2d.terrains.stairs(rise=0.05, edge_radius=0.005),
    ),
}
"""One scenario for every kind of track and terrain."""


def refusal(robot: c2d.Robot | Callable[[], c2d.Robot], **fields: Any) -> c2d.ScenarioError:
    """Return the error for a robot on flat ground, or for making it."""
    with pytest.raises(c2d.ScenarioError) as caught:
        Scenario(
            robot if isinstance(robot, c2d.Robot) else robot(), c2d.terrains.flat(), **fields
        ).validate()
    return caught.value
