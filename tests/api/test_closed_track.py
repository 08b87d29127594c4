"""A belt round the bodies of another model: its shape, and refused values."""

from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.parameters.track import OpenTrack
from tests.shared import GEAR, PLACEMENTS, ROBOT, refusal, with_flippers

STEP = c2d.terrains.step(0.06)


def test_closed_round_the_end_wheels_it_moves_as_the_belt_of_the_outline() -> None:
    """The hull of wheels as large as the ends is the outline; arithmetic differs by rounding."""
    tracks = (c2d.ClosedTrack(c2d.LineOfWheels(5)), c2d.BeltTrack())
    closed, belt = (c2d.simulate(ROBOT.with_track(track), STEP) for track in tracks)
    assert closed.outcome is belt.outcome is c2d.Outcome.CLEARED
    assert closed.position[-1] == pytest.approx(belt.position[-1], abs=1e-6)


def test_wheels_of_half_the_radius_stand_as_much_lower_when_closed() -> None:
    wheels = c2d.LineOfWheels(5, wheel_radius=0.032)
    flat = c2d.terrains.flat()
    at_rest = c2d.Drive(speed=0.0)
    heights = []
    for track in (wheels, c2d.ClosedTrack(wheels)):
        run = c2d.simulate(ROBOT.with_track(track), flat, drive=at_rest, duration=0.5)
        heights.append(run.position[-1, 1])
    assert heights[1] == pytest.approx(heights[0], abs=1e-7)
    assert heights[1] == pytest.approx(0.032, abs=1e-5)


@pytest.mark.parametrize("track", [c2d.LineOfWheels(4, wheel=GEAR), c2d.SegmentalTrack()])
def test_it_has_the_grousers_of_the_model_unless_it_is_to_be_smooth(track: OpenTrack) -> None:
    """With grousers it grips a step that it cannot climb by friction."""
    slippery = c2d.terrains.step(0.06, friction=0.35)
    cleared = {}
    for surface in ("own", "smooth"):
        closed = ROBOT.with_track(c2d.ClosedTrack(track, surface=surface))
        runs = c2d.simulate_many(
            [
                c2d.Scenario(closed, slippery, start=c2d.Start(track_phase=0.008 * i))
                for i in range(6)
            ],
            record="summary",
        )
        cleared[surface] = sum(run.outcome == "cleared" for run in runs)
    assert cleared["own"] > cleared["smooth"]


def test_it_closes_the_arms_too() -> None:
    """A chain or wheels only on the chassis would leave pockets on the arms."""
    robot = with_flippers(c2d.ClosedTrack(c2d.LineOfWheels(5)))
    blade = [(-3.0, 0.0), (0.0, 0.0), (0.0, 0.03), (0.01, 0.03), (0.01, 0.0), (3.0, 0.0)]
    ground = c2d.terrains.from_points(blade, goal=2.0)
    for angle in (0.0, 0.4):
        scenario = c2d.Scenario(robot, ground).replace({"robot.flippers.angle": angle})
        inside = {}
        for track in (robot.track, robot.track.of):  # type: ignore[union-attr]
            run = c2d.simulate(scenario.replace({"robot.track": track}), record="summary")
            inside[track.kind] = run.events["kind"].tolist().count("intrusion")
        assert inside["closed"] == 0
        assert inside["line"] > 0


def test_mass_and_force_are_those_of_the_model() -> None:
    """Servos of all wheels together push as hard as the belt's single motor."""
    wall = c2d.Scenario(ROBOT, c2d.terrains.step(0.5), duration=4.0)
    weak = wall.replace({"robot.drivetrain.max_torque": 0.5})
    servos = weak.replace(
        {
            "robot.track": c2d.ClosedTrack(c2d.LineOfWheels(3)),
            "robot.drivetrain.torque_sharing": "wheel",
        }
    )
    forces = [np.abs(c2d.simulate(each).drive_force).max() for each in (servos, weak)]
    assert forces[0] == pytest.approx(forces[1], rel=1e-6)
    belt_radius = ROBOT.outline.rear_radius - ROBOT.outline.grouser_height
    assert forces[0] == pytest.approx(2 * 0.5 / belt_radius, rel=1e-6)


def test_it_runs_on_lanes() -> None:
    lanes = c2d.terrains.lanes(STEP, c2d.terrains.step(0.05))
    run = c2d.simulate(ROBOT.with_track(c2d.ClosedTrack(c2d.LineOfWheels(3))), lanes)
    belt = c2d.simulate(ROBOT.with_track(c2d.BeltTrack()), lanes)
    assert run.outcome is belt.outcome
    assert run.metrics["final_x"] == pytest.approx(belt.metrics["final_x"], abs=1e-5)


def test_it_survives_its_file() -> None:
    track = c2d.ClosedTrack(c2d.HybridWheels(PLACEMENTS, wheel=GEAR), surface="smooth")
    scenario = c2d.Scenario(ROBOT.with_track(track), STEP)
    assert c2d.Scenario.from_json(scenario.to_json()) == scenario


@pytest.mark.parametrize(
    ("track", "path", "rule"),
    [
        (
            lambda: c2d.ClosedTrack(c2d.LineOfWheels(1)),
            "robot.track.of.count",
            "must be an integer",
        ),
        (
            lambda: c2d.ClosedTrack(c2d.CircumferentialWheels(5)),
            "robot.track.of.count",
            "must be larger",
        ),
        (
            lambda: c2d.ClosedTrack(c2d.BeltTrack(), surface="rough"),  # type: ignore[arg-type]
            "robot.track.surface",
            "must be one",
        ),
        (
            lambda: c2d.ClosedTrack(c2d.ClosedTrack(c2d.BeltTrack())),  # type: ignore[arg-type]
            "robot.track.of",
            "must",
        ),
        (lambda: c2d.ClosedTrack("belt"), "robot.track.of", "must be a"),  # type: ignore[arg-type]
    ],
)
def test_tracks_that_cannot_be_closed_are_refused(track: Any, path: str, rule: str) -> None:
    error = refusal(lambda: ROBOT.with_track(track()))
    assert error.path == path
    assert error.rule.startswith(rule)


def test_a_chain_of_too_light_shoes_is_refused_at_the_mass_of_tracks_when_closed_too() -> None:
    for track in (c2d.SegmentalTrack(shoe_count=400), c2d.SegmentalTrack(shoe_count=399)):
        for model in (track, c2d.ClosedTrack(track)):
            assert refusal(lambda m=model: ROBOT.with_track(m)).path == "robot.track_mass"  # type: ignore[misc]


def test_arms_alone_are_not_closed() -> None:
    robot = with_flippers(c2d.LineOfWheels(5), c2d.ClosedTrack(c2d.LineOfWheels(3)))
    error = refusal(robot)
    assert error.path == "robot.flippers.track"
    assert "closes the arms" in error.rule
