"""Flippers in pictures: that they are drawn where the contacts of a run say that they are."""

from typing import Any

import numpy as np
import pytest
from matplotlib import pyplot as plt

import crawler2d as c2d
from crawler2d import _core
from crawler2d.pictures.shapes import carriers, extent, mass_center, outlines, placed
from tests.pictures.reading import distance, page_of, unpacked
from tests.shared import with_flippers

STEP = c2d.terrains.step(0.2)
LANES = c2d.terrains.lanes(c2d.terrains.step(0.15), c2d.terrains.step(0.12))
BELLY = 3
CLIMB = c2d.Drive(speed=0.4, gait=c2d.Climb())


ROBOTS: dict[str, c2d.Robot] = {
    "belt": with_flippers(c2d.BeltTrack()),
    "grousers": with_flippers(c2d.GrouserBeltTrack()),
    "gears": with_flippers(c2d.LineOfWheels(5, wheel=c2d.GearWheel(grouser_count=8))),
    "wheels in front": with_flippers(c2d.LineOfWheels(5), ends="front"),
    "wheels on a belt": with_flippers(c2d.GrouserBeltTrack(), c2d.LineOfWheels(4), "rear"),
}
SHOES = with_flippers(c2d.SegmentalTrack(), c2d.BeltTrack())


@pytest.fixture(scope="module", params=ROBOTS)
def climb(request: pytest.FixtureRequest) -> c2d.Run:
    # A sample a step: contacts are means over the time between two samples.
    return c2d.simulate(
        ROBOTS[request.param], STEP, drive=CLIMB, duration=4.0, sample_interval=1e-3
    )


@pytest.fixture(scope="module")
def lifted() -> c2d.Run:
    """At rest on flippers that have pushed down while the tracks stood."""
    drive = c2d.Drive(speed=0.0, gait=c2d.Hold(0.8, ((0.2, -0.5),)))
    robot = with_flippers(c2d.GrouserBeltTrack(), ends="front")
    return c2d.simulate(robot, c2d.terrains.flat(), drive=drive, duration=4.0)


def geometry_of(run: c2d.Run) -> Any:
    return _core.geometry(run.scenario.to_json())


def drawn_lines(run: c2d.Run, time: float) -> list[Any]:
    """[m] Of the only pose that is drawn."""
    _, ax = plt.subplots()
    run.plot(time, axes=ax)
    return [np.array(line.get_xydata()) for line in ax.get_lines()]


def test_contacts_lie_on_the_flippers(climb: c2d.Run) -> None:
    table = climb.contacts
    arms = carriers(climb, geometry_of(climb))[1:]
    firsts = [int(arm.track["bodies"].min()) for arm in arms]
    last = int(table["body"][table["body_kind"] == BELLY].min(initial=10**6))
    rows = np.flatnonzero((table["body"] >= firsts[0]) & (table["body"] < last))
    assert len(rows) > 200
    for row in rows[:: len(rows) // 200]:
        sample = int(np.searchsorted(climb.time, table["time"][row]))
        arm = arms[int(np.searchsorted(firsts, table["body"][row], side="right")) - 1]
        place = np.array([table["x"][row], table["y"][row]])
        # In half a step what touches moves by 0.2 mm, and an arc is drawn in sides of 3 degrees.
        assert min(distance(place, line) for line in outlines(arm, sample)) < 5e-4


def test_a_picture_holds_every_track_where_it_is(climb: c2d.Run) -> None:
    for sample in (0, climb.time.size // 2, climb.time.size - 1):
        lines = drawn_lines(climb, climb.time[sample])
        for carrier in carriers(climb, geometry_of(climb)):
            for outline in outlines(carrier, sample):
                assert any(np.array_equal(outline, line) for line in lines)


def test_grousers_travel_round_a_flipper_that_turns_while_the_tracks_stand(
    lifted: c2d.Run,
) -> None:
    table, arm = lifted.contacts, carriers(lifted, geometry_of(lifted))[1]
    first = int(arm.track["bodies"][0])
    assert np.ptp(lifted.drive_positions) < 5e-3
    assert np.ptp(arm.ways) > 0.05
    # Body `first` is the belt of the flipper, the next ones are its grousers.
    count = len(arm.track["grousers"])
    of_arm = (table["body"] > first) & (table["body"] <= first + count)
    now = np.flatnonzero(of_arm & (table["time"] == lifted.time[-1]))
    assert len(now)
    _, *ribs = outlines(arm, lifted.time.size - 1)
    for row in now:
        place = np.array([table["x"][row], table["y"][row]])
        assert distance(place, ribs[table["body"][row] - first - 1]) < 5e-5


def test_the_centre_of_mass_lies_over_the_centre_of_pressure(lifted: c2d.Run) -> None:
    table, geometry = lifted.contacts, geometry_of(lifted)
    lift = table["normal_force"] * table["normal_y"] - table["friction_force"] * table["normal_x"]
    raised, pushing = 19, lifted.time.size - 1  # at rest, both
    for sample in (raised, pushing):
        now = table["time"] == lifted.time[sample]
        pressed = (table["x"] * lift)[now].sum() / lift[now].sum()
        there = placed(lifted, sample, mass_center(lifted, geometry, sample)[None])
        assert there[0, 0] == pytest.approx(pressed, abs=1e-4)
        lines = drawn_lines(lifted, lifted.time[sample])
        assert any(np.array_equal(line, there) for line in lines)
    stretched = np.array(lifted.scenario.robot.center_of_mass)
    assert stretched[0] - mass_center(lifted, geometry, raised)[0] > 3e-3


def test_the_extent_holds_the_flippers(climb: c2d.Run) -> None:
    geometry = geometry_of(climb)
    left, right, bottom, top = extent(climb, geometry)
    for carrier in carriers(climb, geometry):
        for sample in range(0, climb.time.size, 50):
            for outline in outlines(carrier, sample):
                x, y = outline.T
                assert left < x.min() < x.max() < right
                assert bottom < y.min() < y.max() < top
    _, ax = plt.subplots()
    climb.plot(0.0, axes=ax)
    assert (*ax.get_xlim(), *ax.get_ylim()) == (left, right, bottom, top)


def rotation(angle: float) -> Any:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


@pytest.mark.parametrize("robot", [*ROBOTS.values(), SHOES], ids=[*ROBOTS, "shoes"])
def test_the_page_has_the_flippers_to_a_tenth_of_a_millimetre(robot: c2d.Robot) -> None:
    run = c2d.simulate(robot, STEP, drive=CLIMB, duration=4.0)
    page = page_of(run)
    frames, held = page["frames"], page["robot"]
    x, y, turn = (unpacked(frames[column]) for column in ("x", "y", "angle"))
    ways = unpacked(frames["ways"]).reshape(frames["count"], frames["drives"])
    angles = unpacked(frames["flippers"]).reshape(frames["count"], -1)
    arms = carriers(run, geometry_of(run))[1:]
    assert len(arms) == len(held["flippers"]) == angles.shape[1]
    for sample in range(0, frames["count"], 10):
        for k, (arm, flipper) in enumerate(zip(arms, held["flippers"], strict=True)):
            turned = flipper["sign"] * angles[sample, k]
            middle = np.array(flipper["pivot"]) + rotation(turned) @ flipper["arm"]
            origin = rotation(turn[sample]) @ middle + (x[sample], y[sample])
            onto = rotation(turn[sample] + turned).T
            seen = [(wheel["x"], wheel["y"]) for wheel in flipper["wheels"] + flipper["ends"]]
            centers = arm.placed(sample, arm.track["circles"][:, :2])
            assert np.abs(seen @ onto + origin - centers).max() < 1e-4
            for wheel in flipper["wheels"]:
                run_over = ways[sample, wheel["drive"]] + held["drive_radius"] * turned
                assert run_over == pytest.approx(arm.ways[sample, wheel["drive"]], abs=1e-4)
            if flipper["hull"]:
                hull = unpacked(flipper["hull"]).reshape(-1, 2) @ onto + origin
                assert np.abs(hull - outlines(arm, sample)[0][:-1]).max() < 1e-4
            assert len(flipper["grousers"]) == len(arm.track["grousers"])


def test_a_page_without_flippers_has_none() -> None:
    page = page_of(
        c2d.simulate(c2d.robots.engineer(flippers=None), c2d.terrains.flat(), duration=0.5)
    )
    assert page["robot"]["flippers"] == []
    assert not unpacked(page["frames"]["flippers"]).size


def test_an_edge_between_wheels_of_a_flipper_is_marked_and_named() -> None:
    run = c2d.simulate(ROBOTS["gears"], STEP, drive=CLIMB, duration=2.0)
    _, ax = plt.subplots()
    run.plot(1.5, axes=ax)
    (mark,) = [line for line in ax.get_lines() if "inside" in str(line.get_label())]
    assert np.array(mark.get_xydata()).tolist() == [[0.0, 0.2]]
    assert str(mark.get_label()).endswith("between wheels 7 and 8")
    front = geometry_of(run)["flippers"][0]
    assert {7, 8} < set(front["bodies"])
    belts = [line for line in ax.get_lines() if line.get_linestyle() == "--"]
    assert len(belts) == 3
    assert [str(line.get_label()) for line in belts].count("taut belt round the wheels") == 1


@pytest.mark.parametrize("terrain", [STEP, LANES], ids=["one lane", "two lanes"])
def test_an_intrusion_is_in_the_belt_of_what_the_page_says(terrain: Any) -> None:
    run = c2d.simulate(ROBOTS["gears"], terrain, drive=CLIMB, duration=4.0)
    borne = carriers(run, geometry_of(run))
    told = [event for event in page_of(run)["events"] if event["kind"] == "intrusion"]
    assert {event["carrier"] for event in told} == {0, 1, 2}
    lanes = run.events["lane"][run.events["kind"] == "intrusion"]
    for lane, event in zip(lanes, told, strict=True):
        there = (run.edges["id"] == event["edge"]) & (run.edges["lane"] == lane)
        corner = np.array([run.edges["x"][there][0], run.edges["y"][there][0]])
        # The edge is inside at the middle of the event, and only just out at its ends.
        sample = int(np.abs(run.time - 0.5 * (event["start"] + event["end"])).argmin())
        carrier = borne[event["carrier"]]
        belt = carrier.placed(sample, carrier.track["envelope"])
        sides = np.roll(belt, -1, axis=0) - belt
        away = corner - belt
        clear = (sides[:, 0] * away[:, 1] - sides[:, 1] * away[:, 0]) / np.hypot(*sides.T)
        assert clear.min() > -1e-3
