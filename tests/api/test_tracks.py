"""Track models: valid wheels, and refusals."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.track import Track
from tests.shared import GEAR, PLACEMENTS, POINTS, ROBOT, refusal

OUTLINE = ROBOT.outline


@pytest.mark.parametrize(
    "track",
    [
        c2d.BeltTrack(),
        c2d.GrouserBeltTrack(),
        c2d.SegmentalTrack(),
        c2d.ForceTrack(),
        c2d.ClosedTrack(c2d.BeltTrack()),
    ],
)
def test_a_robot_with_a_servo_a_wheel_gets_a_motor_a_belt(track: Track) -> None:
    servos = replace(ROBOT.drivetrain, torque_sharing="wheel")
    wheeled = replace(ROBOT, track=c2d.LineOfWheels(4), drivetrain=servos)
    belted = wheeled.with_track(track)
    belted.wheels()  # breaks no rule
    assert belted.drivetrain.torque_sharing == "track"
    for others in (c2d.LineOfWheels(5), c2d.ClosedTrack(c2d.LineOfWheels(5))):
        assert wheeled.with_track(others).drivetrain.torque_sharing == "wheel"


def test_a_belt_in_place_of_wheels_with_a_motor_each_breaks_no_rule() -> None:
    # As in compare(base, {"wheels": {}, "belt": BeltTrack()}) with a robot from a model file.
    servos = replace(ROBOT.drivetrain, torque_sharing="wheel")
    wheeled = replace(ROBOT, track=c2d.LineOfWheels(4), drivetrain=servos)
    base = Scenario(wheeled, c2d.terrains.step(0.05))
    belted = base.replace({"robot.track": c2d.BeltTrack()})
    belted.validate()
    assert belted.robot == wheeled.with_track(c2d.BeltTrack())
    both = {"robot.drivetrain.torque_sharing": "wheel", "robot.track": c2d.BeltTrack()}
    assert refusal(base.replace(both).robot).path == "robot.drivetrain.torque_sharing"


# Counts and sizes


COUNTED: dict[str, tuple[Callable[[Any], Any], str, int]] = {
    "line": (c2d.LineOfWheels, "count", 2),
    "circumferential": (c2d.CircumferentialWheels, "count", 3),
    "grousers": (
        lambda count: c2d.LineOfWheels(3, wheel=c2d.GearWheel(grouser_count=count)),
        "wheel.grouser_count",
        3,
    ),
    "free wheels": (
        lambda count: c2d.ForceTrack(support="wheels", wheel_count=count),
        "wheel_count",
        2,
    ),
}


@pytest.mark.parametrize("count", [-1, 0, 1, 2.5, 12.0, "12", True, 10_000, 2**70, math.nan])
@pytest.mark.parametrize("name", COUNTED)
def test_an_impossible_count_is_refused(name: str, count: Any) -> None:
    model, path, least = COUNTED[name]
    error = refusal(lambda: ROBOT.with_track(model(count)))
    assert error.path == f"robot.track.{path}"
    if isinstance(count, (str, bool)):
        assert error.rule.startswith("must be a whole number")
    else:
        assert error.rule == f"must be an integer from {least} to 200"


@pytest.mark.parametrize(("count", "works"), [(2, False), (3, True), (200, True), (201, False)])
def test_a_gear_has_3_to_200_grousers(count: int, works: bool) -> None:
    wheel = c2d.GearWheel(grouser_count=count, tip_thickness=0.001)
    robot = ROBOT.with_track(c2d.LineOfWheels(2, wheel=wheel))
    if works:
        run = c2d.simulate(robot, c2d.terrains.flat(), duration=0.2)
        assert run.metrics["distance"] > 0.0
    else:
        assert refusal(robot).path == "robot.track.wheel.grouser_count"


@pytest.mark.parametrize("count", [np.int64(12), np.uint8(12), np.array(12)])
def test_a_count_may_be_a_numpy_integer(count: Any) -> None:
    wheel = c2d.GearWheel(grouser_count=count)
    assert wheel == c2d.GearWheel(grouser_count=12)
    assert type(wheel.grouser_count) is int


@pytest.mark.parametrize("radius", [0, 1e-9, 1e6, -0.01, math.nan, math.inf, "0.01", True])
@pytest.mark.parametrize(
    ("model", "path"),
    [
        (lambda radius: c2d.LineOfWheels(3, wheel_radius=radius), "wheel_radius"),
        (lambda radius: c2d.CircumferentialWheels(24, wheel_radius=radius), "wheel_radius"),
    ],
    ids=["line", "circumferential"],
)
def test_an_impossible_radius_is_refused(model: Any, path: str, radius: Any) -> None:
    error = refusal(lambda: ROBOT.with_track(model(radius)))
    assert error.path == f"robot.track.{path}"
    rules = ("must be >= 0.0001 m and <= 100 m", "must be a number", "must be a finite number")
    assert error.rule.startswith(rules)


@pytest.mark.parametrize(
    ("wheel", "field", "reason"),
    [
        ({"grouser_height": 0.064}, "grouser_height", "to leave a root circle"),
        ({"grouser_height": 0.07}, "grouser_height", "to leave a root circle"),
        ({"grouser_count": 12, "tip_thickness": 0.03}, "tip_thickness", "they would overlap"),
        ({"grouser_count": 200}, "tip_thickness", "they would overlap"),
        ({"grouser_count": 12, "base_thickness": 0.03}, "base_thickness", "they would overlap"),
        ({"base_thickness": 0.004}, "base_thickness", "must be at least the thickness at the tip"),
    ],
)
def test_an_impossible_gear_is_refused_with_the_reason(
    wheel: dict[str, Any], field: str, reason: str
) -> None:
    error = refusal(ROBOT.with_track(c2d.LineOfWheels(3, wheel=c2d.GearWheel(**wheel))))
    assert error.path == f"robot.track.wheel.{field}"
    assert reason in error.rule


def test_the_wheel_that_is_too_small_for_its_grousers_is_named() -> None:
    wheel = c2d.GearWheel(grouser_height=0.04)
    error = refusal(ROBOT.with_track(c2d.HybridWheels(PLACEMENTS, wheel=wheel)))
    assert error.path == "robot.track.wheel.grouser_height"
    assert "wheel 1" in error.rule


@pytest.mark.parametrize("field", ["grouser_height", "grouser_thickness"])
def test_a_robot_without_grousers_gives_a_gear_none(field: str) -> None:
    base = Scenario(ROBOT, c2d.terrains.flat())
    smooth = base.replace({f"robot.outline.{field}": 0.0}).robot
    error = refusal(smooth.with_track(c2d.LineOfWheels(3, wheel=c2d.GearWheel())))
    assert error.path.startswith("robot.track.wheel.")
    assert error.rule.startswith("must be given")
    Scenario(smooth.with_track(c2d.LineOfWheels(3, wheel=GEAR)), c2d.terrains.flat()).validate()


@pytest.mark.parametrize(("radius", "works"), [(0.0019, False), (0.002, True)])
def test_a_wheel_that_turns_too_far_in_a_step_is_refused(radius: float, works: bool) -> None:
    robot = ROBOT.with_track(c2d.CircumferentialWheels(24, wheel_radius=radius))
    coarse, fine, of_an_accuracy = (
        Scenario(robot, c2d.terrains.flat(), solver=solver)
        for solver in (c2d.Solver(time_step=1e-3), c2d.Solver(time_step=5e-4), c2d.Solver())
    )
    fine.validate()
    of_an_accuracy.validate()  # these are as short as needed
    if works:
        coarse.validate()
        return
    with pytest.raises(c2d.ScenarioError) as caught:
        coarse.validate()
    assert caught.value.path == "solver.time_step"
    assert "0.7 rad" in caught.value.rule


# Keywords and combinations


@pytest.mark.parametrize(
    ("make", "keyword"),
    [
        (c2d.GearWheel, "grouser_cuont"),
        (c2d.RoundWheel, "radius"),
        (partial(c2d.LineOfWheels, 3), "wheel_raduis"),
        (partial(c2d.CircumferentialWheels, 24), "Wheel"),
        (c2d.HybridWheels, "placement"),
        (c2d.BeltTrack, "count"),
        (c2d.ForceTrack, "suport"),
        (partial(c2d.terrains.barrier, 0.05), "thicknes"),
        (partial(c2d.terrains.knife_edge, 0.05), "edge_raduis"),
        (c2d.terrains.stairs, "rises"),
        (partial(c2d.terrains.from_points, POINTS, goal=0.0), "frictoin"),
    ],
)
def test_a_misspelt_keyword_is_a_type_error_that_names_it(make: Any, keyword: str) -> None:
    with pytest.raises(TypeError, match=rf"^{keyword} must be a known keyword"):
        make(**{keyword: 1})


@pytest.mark.parametrize(
    "track",
    [c2d.BeltTrack(), c2d.ForceTrack(), c2d.ForceTrack(support="wheels")],
    ids=["belt", "skids", "free wheels"],
)
def test_a_model_without_driven_wheels_has_one_motor(track: Any) -> None:
    scenario = Scenario(ROBOT.with_track(track), c2d.terrains.flat())
    with pytest.raises(c2d.ScenarioError, match="without driven wheels") as caught:
        scenario.replace({"robot.drivetrain.torque_sharing": "wheel"}).validate()
    assert caught.value.path == "robot.drivetrain.torque_sharing"


@pytest.mark.parametrize("wheel", [c2d.RoundWheel(), c2d.GearWheel()], ids=["round", "gear"])
@pytest.mark.parametrize(
    "model",
    [
        lambda wheel: c2d.LineOfWheels(3, wheel=wheel),
        lambda wheel: c2d.CircumferentialWheels(14, wheel=wheel),
        lambda wheel: c2d.HybridWheels(PLACEMENTS, wheel=wheel),
    ],
    ids=["line", "circumferential", "hybrid"],
)
def test_every_driven_wheel_may_have_a_motor_of_its_own(model: Any, wheel: Any) -> None:
    scenario = Scenario(ROBOT.with_track(model(wheel)), c2d.terrains.flat(), duration=0.3)
    run = c2d.simulate(scenario.replace({"robot.drivetrain.torque_sharing": "wheel"}))
    count = len(run.scenario.robot.wheels()) // 2  # both sides
    assert run.drive_speeds.shape[1] == run.drive_positions.shape[1] == count
    assert run.metrics["distance"] > 0.0


# Hybrid wheels: placements as arrays


EXACT: Any = np.array(PLACEMENTS)


@pytest.mark.parametrize(
    "placements",
    [
        EXACT.tolist(),
        tuple(map(tuple, PLACEMENTS)),
        list(EXACT),
        EXACT.astype(np.float32),
        EXACT.astype(np.float16),
        EXACT.astype(">f8"),
        EXACT.astype(np.longdouble),
        np.asfortranarray(EXACT),
        np.repeat(EXACT, 2, axis=0)[::2],
        EXACT.T.copy().T,
    ],
    ids=["lists", "tuples", "arrays", "f4", "f2", ">f8", "longdouble", "Fortran", "strided", "T"],
)
def test_every_real_array_of_placements_gives_the_same_bits(placements: Any) -> None:
    track = c2d.HybridWheels(placements)
    assert track == c2d.HybridWheels(EXACT)
    assert all(type(x) is float for placement in track.placements for x in placement)
    scenario = Scenario(ROBOT.with_track(track), c2d.terrains.flat())
    same = scenario.replace({"robot.track": c2d.HybridWheels(EXACT)})
    assert scenario.identity == same.identity


@pytest.mark.parametrize("dtype", [np.int64, np.uint8, np.int16])
def test_whole_numbers_are_placements(dtype: Any) -> None:
    whole: Any = np.array([[0, 0, 1], [3, 0, 1]])
    assert c2d.HybridWheels(whole.astype(dtype)) == c2d.HybridWheels(whole.astype(float))


@pytest.mark.parametrize(
    ("placements", "path"),
    [
        ([[0.0, 0.0, 0.1], [0.1, 0.0]], "robot.track.placements[1]"),
        ([[0.0, 0.0, 0.1], 0.1], "robot.track.placements[1]"),
        (np.zeros((3, 2)), "robot.track.placements"),
        (np.zeros((3, 4)), "robot.track.placements"),
        (np.zeros(3), "robot.track.placements"),
        (np.zeros((1, 1, 3)), "robot.track.placements"),
        (np.ones((2, 3), dtype=bool), "robot.track.placements"),
        (np.ones((2, 3), dtype=complex), "robot.track.placements"),
        (np.ma.masked_array(EXACT), "robot.track.placements"),
        ([["0", "0", "1"]], "robot.track.placements"),
        ("placements", "robot.track.placements"),
        (0.1, "robot.track.placements"),
        (object(), "robot.track.placements"),
    ],
)
def test_anything_but_placements_is_refused_at_once(placements: Any, path: str) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        c2d.HybridWheels(placements)
    assert caught.value.path == path
    assert caught.value.rule.startswith("must")


@pytest.mark.parametrize(
    ("placements", "path", "rule"),
    [
        ([], "placements", "must place at least one wheel"),
        (None, "placements", "must be a list of circles (x, y, radius)"),
        (np.zeros((201, 3)), "placements", "must have at most 200 rows"),
        ([[0, 0, 0.1], [0, math.nan, 0.1]], "placements[1][1]", "must be a finite number"),
        ([[-math.inf, 0, 0.1]], "placements[0][0]", "must be a finite number"),
        ([[0, 0, 0.0]], "placements[0][2]", "must be >= 0.0001 m and <= 100 m"),
        ([[0, 0, 1e-9]], "placements[0][2]", "must be >= 0.0001 m and <= 100 m"),
        ([[0, 0, 1e6]], "placements[0][2]", "must be >= 0.0001 m and <= 100 m"),
    ],
)
def test_placements_that_make_no_wheels_are_refused(placements: Any, path: str, rule: str) -> None:
    error = refusal(lambda: ROBOT.with_track(c2d.HybridWheels(placements)))
    assert (error.path, error.rule) == (f"robot.track.{path}", rule)
