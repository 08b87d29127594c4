"""Flippers in pictures are drawn where the contacts of a run are."""

from typing import Any

import numpy as np
import pytest
from matplotlib import pyplot as plt

import crawler2d as c2d
from crawler2d.pictures.scenes import scene_of
from tests.pictures.reading import distance, page_of, placed
from tests.shared import with_flippers

STEP = c2d.terrains.step(0.2)
LANES = c2d.terrains.lanes(c2d.terrains.step(0.2), c2d.terrains.step(0.17))
CLIMB = c2d.Drive(speed=0.4, gait=c2d.Climb())


ROBOTS: dict[str, c2d.Robot] = {
    "belt": with_flippers(c2d.BeltTrack()),
    "grousers": with_flippers(c2d.GrouserBeltTrack()),
    "gears": with_flippers(c2d.LineOfWheels(5, wheel=c2d.GearWheel(grouser_count=8))),
    "wheels in front": with_flippers(c2d.LineOfWheels(5), ends="front"),
    "wheels on a belt": with_flippers(c2d.GrouserBeltTrack(), c2d.LineOfWheels(4), "rear"),
}


@pytest.fixture(scope="module", params=ROBOTS)
def climb(request: pytest.FixtureRequest) -> c2d.Run:
    # A sample a step: contacts are means over the time between two samples, in the middle of steps.
    return c2d.simulate(
        ROBOTS[request.param],
        STEP,
        drive=CLIMB,
        duration=4.0,
        solver=c2d.Solver(time_step=1e-3),
        sample_interval=1e-3,
    )


@pytest.fixture(scope="module")
def lifted() -> c2d.Run:
    """At rest on flippers that have pushed down while the tracks stood."""
    drive = c2d.Drive(speed=0.0, gait=c2d.Hold(0.8, ((0.2, -0.5),)))
    robot = with_flippers(c2d.GrouserBeltTrack(), ends="front")
    return c2d.simulate(robot, c2d.terrains.flat(), drive=drive, duration=4.0)


def drawn_lines(run: c2d.Run, time: float) -> list[Any]:
    """[m] Lines of the only pose that is drawn."""
    _, ax = plt.subplots()
    run.plot(ax, time=time)
    return [np.array(line.get_xydata()) for line in ax.get_lines()]


def test_contacts_lie_on_the_flippers(climb: c2d.Run) -> None:
    table, scene = climb.contacts, scene_of(climb)
    of_arms = np.concatenate([arm.bodies for arm in scene.carriers[1:]])
    rows = np.flatnonzero(np.isin(table["body"], of_arms))
    assert len(rows) > 200
    for row in rows[:: len(rows) // 200]:
        sample = int(np.searchsorted(climb.time, table["time"][row]))
        place = np.array([table["x"][row], table["y"][row]])
        # In half a step the touching part moves by 0.2 mm; an arc is drawn in sides of 3 degrees.
        assert distance(place, scene.outline(table["body"][row], sample)) < 5e-4


def test_a_picture_holds_every_track_where_it_is(climb: c2d.Run) -> None:
    for sample in (0, climb.time.size // 2, climb.time.size - 1):
        lines = drawn_lines(climb, climb.time[sample])
        scene = scene_of(climb)
        for row in np.flatnonzero(climb.bodies["body"] >= 0).tolist():
            outline = scene.outline(row, sample)
            assert any(np.array_equal(outline, line) for line in lines)


def test_grousers_travel_round_a_flipper_that_turns_while_the_tracks_stand(
    lifted: c2d.Run,
) -> None:
    table, scene = lifted.contacts, scene_of(lifted)
    circuit = scene.carriers[1].circuit
    assert circuit is not None
    assert np.ptp(lifted.drive_positions) < 5e-3
    assert np.ptp(scene.travels[:, circuit.belt]) > 0.05
    of_arm = np.isin(table["body"], circuit.grousers)
    now = np.flatnonzero(of_arm & (table["time"] == lifted.time[-1]))
    assert len(now)
    for row in now:
        place = np.array([table["x"][row], table["y"][row]])
        assert distance(place, scene.outline(table["body"][row], -1)) < 5e-5


def test_the_centre_of_mass_lies_over_the_centre_of_pressure(lifted: c2d.Run) -> None:
    table, scene = lifted.contacts, scene_of(lifted)
    lift = table["normal_force"] * table["normal_y"] - table["friction_force"] * table["normal_x"]
    raised, pushing = 19, lifted.time.size - 1  # at rest, both
    for sample in (raised, pushing):
        now = table["time"] == lifted.time[sample]
        pressed = (table["x"] * lift)[now].sum() / lift[now].sum()
        there = scene.center_of_mass[sample][None]
        assert there[0, 0] == pytest.approx(pressed, abs=1e-4)
        lines = drawn_lines(lifted, lifted.time[sample])
        assert any(np.array_equal(line, there) for line in lines)
    stretched = np.array(lifted.scenario.robot.center_of_mass)
    drawn_in = scene.center_of_mass[raised] - lifted.position[raised]
    assert stretched[0] - drawn_in[0] > 3e-3


def test_the_extent_holds_the_flippers(climb: c2d.Run) -> None:
    scene = scene_of(climb)
    left, right, bottom, top = scene.extent()
    for row in range(len(scene.kinds)):
        for sample in range(0, climb.time.size, 50):
            x, y = scene.outline(row, sample).T
            assert left < x.min() < x.max() < right
            assert bottom < y.min() < y.max() < top
    _, ax = plt.subplots()
    climb.plot(ax, time=0.0)
    assert (*ax.get_xlim(), *ax.get_ylim()) == (left, right, bottom, top)


def test_a_page_without_flippers_has_none() -> None:
    page = page_of(
        c2d.simulate(c2d.robots.engineer(flippers=None), c2d.terrains.flat(), duration=0.5)
    )
    assert len(page["robot"]["carriers"]) == 1


def test_an_edge_between_wheels_of_a_flipper_is_marked_and_named() -> None:
    run = c2d.simulate(ROBOTS["gears"], STEP, drive=CLIMB, duration=2.0)
    _, ax = plt.subplots()
    run.plot(ax, time=1.5)
    (mark,) = [line for line in ax.get_lines() if "inside" in str(line.get_label())]
    assert np.array(mark.get_xydata()).tolist() == [[0.0, 0.2]]
    assert str(mark.get_label()).endswith("between wheels 7 and 8")
    assert set(run.bodies["carrier"][[7, 8]]) == {"front flipper"}
    belts = [line for line in ax.get_lines() if line.get_linestyle() == "--"]
    assert len(belts) == 3
    assert [str(line.get_label()) for line in belts].count(
        "envelope (taut belt round the wheels)"
    ) == 1


# Over the lower edge of two lanes the rear arms pass without one.
@pytest.mark.parametrize(
    ("terrain", "carriers"),
    [(STEP, {0, 1, 2}), (LANES, {0, 1})],
    ids=["one lane", "two lanes"],
)
def test_an_intrusion_is_in_the_belt_of_what_the_page_says(
    terrain: Any, carriers: set[int]
) -> None:
    run = c2d.simulate(ROBOTS["gears"], terrain, drive=CLIMB, duration=6.0)
    assert run.outcome == "cleared"
    borne = scene_of(run).carriers
    told = [event for event in page_of(run)["events"] if event["kind"] == "intrusion"]
    assert carriers <= {event["carrier"] for event in told}
    lanes = run.events["lane"][run.events["kind"] == "intrusion"]
    for lane, event in zip(lanes, told, strict=True):
        there = (run.edges["id"] == event["edge"]) & (run.edges["lane"] == lane)
        corner = np.array([run.edges["x"][there][0], run.edges["y"][there][0]])
        # The edge is inside at the middle of the event, and only just out at its ends.
        sample = int(np.abs(run.time - 0.5 * (event["start"] + event["end"])).argmin())
        carrier = borne[event["carrier"]]
        belt = placed(carrier.envelope, carrier.poses[sample])
        sides = np.roll(belt, -1, axis=0) - belt
        away = corner - belt
        clear = (sides[:, 0] * away[:, 1] - sides[:, 1] * away[:, 0]) / np.hypot(*sides.T)
        assert clear.min() > -1e-3


@pytest.mark.filterwarnings("ignore:robot.flippers.tip_radius has no effect")
def test_large_wheels_at_the_tips_of_arms_fit_into_the_view() -> None:
    """Arms of 0.34 m with wheels of 0.12 m; their tips are smaller without wheels."""
    arms = c2d.Flippers(
        length=0.34, root_radius=0.064, tip_radius=0.037, mass=0.775, torque_limit=30.0
    )
    lengths = []
    for track in (c2d.BeltTrack(), c2d.LineOfWheels(4, wheel_radius=0.12)):
        robot = c2d.robots.engineer(flippers=arms, track=track)
        run = c2d.simulate(robot, c2d.terrains.flat(), duration=0.05)
        lengths.append(page_of(run)["robot"]["length"])
    assert np.diff(lengths) == pytest.approx(0.12 - 0.037)
