"""Positions of a robot's bodies agree in contacts, in `Run.poses` and on pages."""

from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d import _core
from crawler2d.pictures.scenes import scene_of
from tests.pictures.reading import PageRobot, distance, page_of, placed
from tests.shared import GEAR, ROBOT, with_flippers

STEP = c2d.terrains.step(0.06)
HIGH = c2d.terrains.step(0.2)
LANES = c2d.terrains.lanes(c2d.terrains.step(0.05), c2d.terrains.step(0.03))
SPROCKET = c2d.SegmentalTrack(mechanism="sprocket")
SCENES: dict[str, tuple[c2d.Robot, Any]] = {
    "belt": (ROBOT, STEP),
    "belt on two lanes": (ROBOT, LANES),
    "grousers": (ROBOT.with_track(c2d.GrouserBeltTrack()), STEP),
    "wheels": (ROBOT.with_track(c2d.LineOfWheels(5)), STEP),
    "gears on two lanes": (ROBOT.with_track(c2d.LineOfWheels(4, wheel=GEAR)), LANES),
    "ring of gears": (ROBOT.with_track(c2d.CircumferentialWheels(24, wheel=GEAR)), STEP),
    "skids": (ROBOT.with_track(c2d.ForceTrack()), STEP),
    "free wheels": (ROBOT.with_track(c2d.ForceTrack(support="wheels")), STEP),
    "shoes": (ROBOT.with_track(c2d.SegmentalTrack()), STEP),
    "sprockets on two lanes": (ROBOT.with_track(SPROCKET), LANES),
    "belts on arms": (with_flippers(c2d.GrouserBeltTrack(), c2d.BeltTrack()), HIGH),
    "grousers on arms": (with_flippers(c2d.GrouserBeltTrack()), HIGH),
    "gears on arms": (with_flippers(c2d.LineOfWheels(5, wheel=c2d.GearWheel())), HIGH),
    "shoes and arms": (with_flippers(c2d.SegmentalTrack(), c2d.BeltTrack()), HIGH),
}


@pytest.fixture(scope="module", params=SCENES)
def run(request: pytest.FixtureRequest) -> c2d.Run:
    robot, terrain = SCENES[request.param]
    gait = c2d.Climb() if robot.flippers else None
    # A sample a step: contacts are means over the time between two samples.
    drive = c2d.Drive(speed=0.4, gait=gait)
    return c2d.simulate(robot, terrain, drive=drive, duration=2.5, sample_interval=1e-3)


def test_contacts_lie_on_the_outline_of_their_body(run: c2d.Run) -> None:
    table, bodies, poses = run.contacts, run.bodies, run.poses
    assert (bodies["kind"][table["body"]] == table["body_kind"]).all()
    is_belly = table["body_kind"] == c2d.BodyKind.BELLY
    assert (bodies["lane"][table["body"]] == table["lane"])[~is_belly].all()
    rows = np.flatnonzero(run.time[10] < table["time"])
    far = []
    for row in rows[:: max(1, len(rows) // 300)]:
        sample, body = int(np.searchsorted(run.time, table["time"][row])), table["body"][row]
        outline = placed(bodies["outline"][body], poses[sample, body])
        point = np.array([table["x"][row], table["y"][row]])
        far.append(distance(point, np.vstack([outline, outline[:1]])) - table["penetration"][row])
    assert len(far) > 100
    # Contacts are found half a step earlier: touching parts have moved by 0.2 mm since then, a
    # swinging shoe by more. An arc of a belt is drawn in sides of 3 degrees.
    assert np.quantile(far, 0.95) < 3e-4
    assert max(far) < 1.5e-3


def test_bodies_are_numbered_as_in_the_contacts(run: c2d.Run) -> None:
    numbers = run.bodies["body"]
    meets = numbers >= 0
    assert numbers[meets].tolist() == list(range(np.count_nonzero(meets)))
    assert (numbers[~meets] == -1).all()
    assert run.poses.shape == (run.time.size, len(run.bodies), 3)


def test_angles_count_full_turns(run: c2d.Run) -> None:
    # No body turns by half a turn within a step of 1 ms, so none may jump by a full one.
    assert np.abs(np.diff(run.poses[..., 2], axis=0)).max() < 0.5


def test_the_page_has_every_body_to_a_tenth_of_a_millimetre(run: c2d.Run) -> None:
    scene, robot = scene_of(run), PageRobot(page_of(run))
    near = np.concatenate([carrier.bodies for carrier in scene.carriers])
    for sample in range(0, run.time.size, 250):
        drawn = robot.outlines(sample)
        assert len(drawn) == len(near)
        for row in near:
            line, kind = scene.outline(row, sample)[:-1], scene.kinds[row].name.lower()
            number = scene.bodies["body"][row]
            alike = [
                np.abs(there - line).max()
                for _, body, there in drawn
                if there.shape == line.shape and body in (number, None, plate_of(scene.bodies, row))
            ]
            assert min(alike) < 1e-4, kind


def plate_of(bodies: dict[str, Any], row: int) -> int | None:
    """The number of the plate that a page has for all pieces of a shoe."""
    is_plate = (bodies["shoe"] == bodies["shoe"][row]) & (bodies["kind"] == c2d.BodyKind.SHOE)
    return int(np.flatnonzero(is_plate)[0]) if bodies["shoe"][row] >= 0 else None


@pytest.mark.parametrize(
    ("robot", "sharing", "first"),
    [
        (ROBOT.with_track(c2d.LineOfWheels(4)), "track", [0, 0, 0, 0]),
        (ROBOT.with_track(c2d.LineOfWheels(4)), "wheel", [0, 1, 2, 3]),
        (ROBOT.with_track(c2d.ForceTrack(support="wheels")), "track", [1, 2, 3, 4, 5]),
    ],
    ids=["one motor", "one a wheel", "free wheels"],
)
def test_every_wheel_turns_with_its_own_drive(
    robot: c2d.Robot, sharing: str, first: list[int]
) -> None:
    scenario = c2d.Scenario(robot, STEP, duration=2.0)
    run = c2d.simulate(scenario.replace({"robot.drivetrain.torque_sharing": sharing}))
    for body, drive in enumerate(first):
        turned = run.chassis_angle - run.poses[:, body, 2]
        way = turned * run.bodies["radius"][body]
        assert way == pytest.approx(run.drive_positions[:, drive], abs=1e-12)


def test_grousers_stand_on_their_belt_and_go_round_with_it() -> None:
    robot = ROBOT.with_track(c2d.GrouserBeltTrack(grouser_count=11))
    run = c2d.simulate(robot, c2d.terrains.flat(), duration=6.0)
    bodies, poses = run.bodies, run.poses
    grousers = np.flatnonzero(bodies["kind"] == c2d.BodyKind.GROUSER)
    assert len(grousers) == 11
    height = robot.outline.grouser_height
    for sample in range(0, run.time.size, 40):
        belt = placed(bodies["outline"][0], poses[sample, 0])
        for row in grousers:
            (tip,) = placed(np.array([[0.0, height]]), poses[sample, row])
            # The belt's arcs are cut every 0.05 rad: a side lies 1.5e-5 m below its arc.
            gap = distance(tip, np.vstack([belt, belt[:1]]))
            assert gap == pytest.approx(height, abs=2e-5)
    length = _core.geometry(run.scenario.to_json())["carriers"][0]["circuit"]["ways"][-1]
    rounds = np.ptp(run.drive_positions) / length
    assert rounds > 1.5
    turned = poses[:, grousers, 2] - run.chassis_angle[:, None]
    # On its way round a belt turns it by turns, at its ends.
    assert (turned[0] - turned[-1]) / (2.0 * np.pi) == pytest.approx(rounds, abs=0.5)


@pytest.mark.parametrize("track", [c2d.SegmentalTrack(), SPROCKET], ids=["guide", "sprocket"])
def test_the_pins_of_neighbouring_shoes_meet(track: c2d.SegmentalTrack) -> None:
    run = c2d.simulate(ROBOT.with_track(track), STEP, duration=3.0)
    bodies, poses = run.bodies, run.poses
    plates = np.flatnonzero(bodies["kind"] == c2d.BodyKind.SHOE)
    half = bodies["outline"][plates[0]][:, 0].max()
    assert bodies["shoe"][plates].tolist() == list(range(run.shoe_poses.shape[1]))
    for sample in range(run.time.size):
        pins = [
            [placed(np.array([[side * half, 0.0]]), poses[sample, row])[0] for row in plates]
            for side in (1.0, -1.0)
        ]
        gaps = np.array(pins[0]) - np.roll(pins[1], -1, axis=0)
        assert np.hypot(*gaps.T).max() <= run.metrics["max_pin_gap"] + 1e-9


def test_wheels_within_a_belt_turn_with_it_on_an_arm_that_turns() -> None:
    drive = c2d.Drive(speed=0.0, gait=c2d.Hold(0.8, ((0.2, -0.5),)))
    run = c2d.simulate(
        with_flippers(c2d.BeltTrack(), ends="front"), c2d.terrains.flat(), drive=drive, duration=3.0
    )
    bodies = run.bodies
    turned = np.ptp(run.poses[..., 2] - run.chassis_angle[:, None], axis=0)
    assert np.ptp(run.drive_positions) < 5e-3
    within = bodies["body"] < 0
    on_arm = within & (bodies["carrier"] == "front flipper")
    sprocket = on_arm & (bodies["kind"] == c2d.BodyKind.SPROCKET)
    idler = on_arm & (bodies["kind"] == c2d.BodyKind.IDLER)
    # The wheel on the pivot turns with the chassis, except for the yielding of the drive; the other
    # one rolls on the belt.
    assert turned[sprocket].max() < 0.1
    assert turned[idler].min() > 0.5


def test_a_run_without_history_has_bodies_and_no_poses() -> None:
    run = c2d.simulate(ROBOT, c2d.terrains.flat(), duration=0.2, record="summary")
    assert len(run.bodies) == 4
    with pytest.raises(AttributeError, match="no history"):
        _ = run.poses


def test_columns_of_another_robot_are_refused_by_name() -> None:
    run = c2d.simulate(ROBOT, c2d.terrains.flat(), duration=0.2)
    names = ("position", "chassis_angle", "drive_positions", "shoe_poses", "flipper_angles")
    columns = {name: getattr(run, name) for name in names}
    other = c2d.Scenario(c2d.robots.engineer(), c2d.terrains.flat())
    with pytest.raises(c2d.ScenarioError) as caught:
        _core.poses(other.to_json(), columns)
    assert caught.value.path == "flipper_angles"
