"""Edges inside the track: pieces of ground whose depth and area are known beforehand."""

import dataclasses
import itertools
import math
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from tests.shared import ROBOT

# Three wheels with slots of 26 mm between them.
RADIUS, SPACING = 0.08, 0.186
PLACEMENTS = ((-SPACING, 0.0, RADIUS), (0.0, 0.0, RADIUS), (SPACING, 0.0, RADIUS))
APPROACH = 0.1
MIDDLE = -APPROACH - RADIUS - SPACING  # [m] x of the middle wheel at the start
THICKNESS, HEIGHT = 0.02, 0.01
# [m] The belt that bounds pieces is this far inside the wheels' circles.
MARGIN = c2d.SeizureCriteria().intrusion_depth
POST_AREA = THICKNESS * (HEIGHT - MARGIN)
WEDGE_AREA = 0.5 * THICKNESS / HEIGHT * (HEIGHT - MARGIN) ** 2


def standing(
    *obstacles: list[tuple[float, float]], wheel: Any = None, **fields: Any
) -> c2d.Scenario:
    """Stand three wheels on level ground with obstacles under them; the first edge lies ahead."""
    points = [(-3.0, 0.0), *(p for o in obstacles for p in o), (0.0, 0.0), (0.0, 0.2), (3.0, 0.2)]
    track = c2d.HybridWheels(PLACEMENTS, wheel=wheel or c2d.RoundWheel())
    return Scenario(
        ROBOT.with_track(track),
        c2d.terrains.from_points(points, goal=0.0),
        drive=c2d.Drive(speed=0.0),
        start=c2d.Start(approach=APPROACH),
        **fields,
    )


def post(center: float) -> list[tuple[float, float]]:
    left, right = center - 0.5 * THICKNESS, center + 0.5 * THICKNESS
    return [(left, 0.0), (left, HEIGHT), (right, HEIGHT), (right, 0.0)]


def wedge(center: float) -> list[tuple[float, float]]:
    return [(center - 0.5 * THICKNESS, 0.0), (center, HEIGHT), (center + 0.5 * THICKNESS, 0.0)]


FRONT, REAR = MIDDLE + 0.5 * SPACING, MIDDLE - 0.5 * SPACING


def test_level_ground_is_outside_the_track() -> None:
    inside = c2d.Simulation(standing()).intrusions()
    assert len(inside) == 0
    assert list(inside) == [
        "lane",
        "edge",
        "edges",
        "bodies",
        "depth",
        "root_depth",
        "area",
        "x",
        "y",
    ]


def test_without_a_least_depth_the_ground_under_all_wheels_is_one_piece() -> None:
    criteria = c2d.SeizureCriteria(intrusion_depth=0.0)
    sim = c2d.Simulation(standing(post(REAR), wedge(FRONT), criteria=criteria))
    sim.advance(0.5)  # until the wheels have settled
    inside = sim.intrusions()
    assert inside["edges"].tolist() == [(0, 1, 2, 3, 4, 5, 6)]
    whole = THICKNESS * HEIGHT * 1.5
    assert inside["area"] == pytest.approx([whole], rel=0.01)  # and the penetrated ground


def test_no_area_is_below_zero() -> None:
    robot = ROBOT.with_track(c2d.LineOfWheels(3, wheel=c2d.GearWheel()))
    criteria = c2d.SeizureCriteria(intrusion_depth=0.0)
    sim = c2d.Simulation(Scenario(robot, c2d.terrains.step(0.05), criteria=criteria))
    pieces = 0
    for _ in range(200):
        sim.advance(0.01)
        area = sim.intrusions()["area"]
        pieces += len(area)
        assert not np.signbit(area).any()  # nor -0.0
    assert pieces > 100


@pytest.mark.parametrize(
    ("slot", "bodies"), [(FRONT, (2, 1)), (REAR, (1, 0))], ids=["front slot", "rear slot"]
)
def test_a_post_in_a_slot_is_as_deep_and_large_inside_as_it_is(
    slot: float, bodies: tuple[int, int]
) -> None:
    inside = c2d.Simulation(standing(post(slot))).intrusions()
    assert inside["bodies"].tolist() == [bodies]
    assert inside["depth"] == pytest.approx([HEIGHT])
    assert inside["root_depth"] == pytest.approx([HEIGHT])
    assert inside["area"] == pytest.approx([POST_AREA])
    assert inside["y"] == pytest.approx([HEIGHT])
    assert abs(inside["x"][0] - slot) <= 0.5 * THICKNESS + 1e-12
    assert inside["edge"].tolist() == [1]  # the left of equally deep ones
    assert inside["edges"].tolist() == [(1, 2)]


def test_the_point_of_a_wedge_is_the_deepest() -> None:
    inside = c2d.Simulation(standing(wedge(FRONT))).intrusions()
    assert inside["edge"].tolist() == [1]
    assert (inside["x"][0], inside["y"][0]) == pytest.approx((FRONT, HEIGHT))
    assert inside["depth"] == pytest.approx([HEIGHT])
    assert inside["area"] == pytest.approx([WEDGE_AREA])


def test_pieces_are_listed_from_the_left() -> None:
    inside = c2d.Simulation(standing(post(REAR), wedge(FRONT))).intrusions()
    assert inside["bodies"].tolist() == [(1, 0), (2, 1)]
    assert inside["area"] == pytest.approx([POST_AREA, WEDGE_AREA])
    with pytest.raises(ValueError, match="read-only"):
        inside["depth"][0] = 0.0


@pytest.mark.parametrize("side", [-1.0, 1.0], ids=["behind", "before"])
def test_a_post_outside_the_track_is_not_inside(side: float) -> None:
    outside = MIDDLE + side * (SPACING + RADIUS + THICKNESS)
    assert len(c2d.Simulation(standing(post(outside))).intrusions()) == 0


def test_gears_are_entered_by_their_height_less_below_the_roots() -> None:
    height = 0.012
    sim = c2d.Simulation(standing(wedge(FRONT), wheel=c2d.GearWheel(grouser_height=height)))
    sunk = RADIUS - sim.state().position[1]  # no grouser points straight down
    inside = sim.intrusions()
    deepest = int(inside["depth"].argmax())
    assert 0.0 < sunk < height
    assert inside["edge"][deepest] == 1
    assert inside["depth"][deepest] == pytest.approx(HEIGHT + sunk)
    assert inside["root_depth"][deepest] == pytest.approx(max(HEIGHT + sunk - height, 0.0))


def test_a_wedge_in_a_slot_is_an_event_that_lasts() -> None:
    run = c2d.simulate(standing(wedge(FRONT), duration=0.2))
    assert run.events["kind"].tolist() == ["intrusion"]
    assert run.events["start"][0] == pytest.approx(0.0, abs=2e-3)
    assert run.events["end"][0] == pytest.approx(run.time[-1], abs=0.01)
    assert run.events["edge"].tolist() == [1]
    assert run.events["bodies"].tolist() == [(2, 1)]
    assert run.events["depth"] == pytest.approx([HEIGHT], abs=2e-5)
    assert run.events["root_depth"].tolist() == run.events["depth"].tolist()
    assert run.metrics["intrusion_depth"] == run.events["depth"][0]
    assert run.metrics["stopped_time"] == 0.0


def test_an_event_that_lasts_ends_with_its_run() -> None:
    run = c2d.simulate(standing(wedge(FRONT), duration=0.205))
    assert run.events["end"][0] == run.time[-1]


def test_a_wedge_that_nothing_touches_carries_no_force() -> None:
    run = c2d.simulate(standing(wedge(FRONT), duration=0.2))
    assert run.events["force"].tolist() == [0.0]
    assert run.metrics["intrusion_force"] == 0.0


def test_a_flat_top_is_one_event() -> None:
    run = c2d.simulate(standing(post(FRONT), duration=0.2))
    assert run.events["kind"].tolist() == ["intrusion"]


@pytest.mark.parametrize(("depth", "events"), [(0.009, 1), (0.011, 0)])
def test_ground_shallower_than_the_criterion_is_no_event(depth: float, events: int) -> None:
    criteria = c2d.SeizureCriteria(intrusion_depth=depth)
    run = c2d.simulate(standing(wedge(FRONT), duration=0.1, criteria=criteria))
    assert len(run.events) == events
    assert run.metrics["intrusion_depth"] == pytest.approx(HEIGHT if events else 0.0, abs=2e-5)


@pytest.fixture(scope="module")
def seized() -> c2d.Run:
    """Touching wheels with the edge of a step between them."""
    track = c2d.LineOfWheels(4, wheel_radius=0.0608)
    return c2d.simulate(ROBOT.with_track(track), c2d.terrains.step(0.10), duration=4.0)


def test_a_stop_carries_the_most_loaded_intrusion_at_its_end(seized: c2d.Run) -> None:
    events = seized.events
    assert np.all(np.diff(events["start"]) >= 0.0)
    (stop,) = np.flatnonzero(events["kind"] == "stop")
    lasting = np.flatnonzero((events["kind"] == "intrusion") & (events["end"] > 3.98))
    cause = lasting[events["force"][lasting].argmax()]
    for name in ("edge", "bodies", "depth", "root_depth", "force"):
        assert events[name][stop] == events[name][cause]
    assert (events["edge"][stop], events["bodies"][stop]) == (1, (2, 1))
    assert seized.metrics["intrusion_depth"] == events["depth"][stop]
    assert seized.metrics["intrusion_root_depth"] == events["root_depth"][stop]
    assert seized.metrics["intrusion_force"] == events["force"][stop]
    assert seized.metrics["stopped_time"] == pytest.approx(
        events["end"][stop] - events["start"][stop]
    )


def test_the_force_on_an_intrusion_is_that_of_the_contacts_there(seized: c2d.Run) -> None:
    contacts, last = seized.contacts, seized.contacts["time"] > 3.0
    on_step = last & (contacts["y"] > 0.05)  # at its edge and on its top
    mean = contacts["normal_force"][on_step].sum() / len(set(contacts["time"][last]))
    (stop,) = np.flatnonzero(seized.events["kind"] == "stop")
    assert seized.events["force"][stop] == pytest.approx(mean, rel=0.05)
    assert mean > 0.02 * ROBOT.mass * 9.81


def test_a_simulation_finds_the_same_inside_as_the_run(seized: c2d.Run) -> None:
    sim = c2d.Simulation(seized.scenario)
    sim.advance(4.0)
    inside = sim.intrusions()
    (row,) = np.flatnonzero(inside["edge"] == 1)
    assert inside["bodies"][row] == (2, 1)
    assert inside["depth"][row] == pytest.approx(seized.metrics["intrusion_depth"], abs=1e-3)
    assert math.hypot(inside["x"][row], inside["y"][row] - 0.10) < 1e-6


def test_a_stop_before_a_wall_carries_no_edge() -> None:
    robot = ROBOT.with_track(c2d.ForceTrack(support="wheels"))
    run = c2d.simulate(robot, c2d.terrains.step(0.2))
    assert run.outcome is c2d.Outcome.STALLED
    assert run.events["kind"].tolist() == ["stop"]
    assert run.events["edge"].tolist() == [-1]
    assert run.events["bodies"].tolist() == [()]
    assert run.events["depth"].tolist() == run.events["force"].tolist() == [0.0]
    assert run.metrics["intrusion_depth"] == run.metrics["intrusion_force"] == 0.0


@pytest.mark.parametrize(
    ("track", "terrain"),
    [
        pytest.param(c2d.LineOfWheels(2), c2d.terrains.barrier(0.02, 0.03), id="one edge leaves"),
        pytest.param(
            c2d.CircumferentialWheels(12, wheel_radius=0.02),
            c2d.terrains.ridge(0.06, 0.6),
            id="as far from two stretches of the belt",
        ),
    ],
)
def test_an_intrusion_between_the_same_bodies_does_not_end_and_begin_again(
    track: Any, terrain: Any
) -> None:
    events = c2d.simulate(ROBOT.with_track(track), terrain, duration=4.0).events
    inside = np.flatnonzero(events["kind"] == "intrusion")
    assert inside.size
    for i, j in itertools.permutations(inside, 2):
        if events["bodies"][i] == events["bodies"][j]:
            assert abs(events["start"][j] - events["end"][i]) > 0.011  # the next look


@pytest.mark.parametrize("criterion", [5e-4, 0.009])
def test_a_depth_does_not_depend_on_the_criterion(criterion: float) -> None:
    # The lower run is level: from a small wheel under a large one to another large one.
    track = c2d.HybridWheels(((-0.15, -0.05, 0.01), (-0.15, 0.02, 0.06), (0.15, 0.0, 0.06)))
    robot = dataclasses.replace(ROBOT.with_track(track), belly=None)
    height, nose = 0.03, 0.5 * ROBOT.outline.axle_distance + ROBOT.outline.front_radius
    center = -APPROACH - nose - 0.1
    under = [(center - 0.01, 0.0), (center, height), (center + 0.01, 0.0)]
    points = [(-3.0, 0.0), *under, (0.0, 0.0), (0.0, 0.2), (3.0, 0.2)]
    scenario = Scenario(
        robot,
        c2d.terrains.from_points(points, goal=0.0),
        start=c2d.Start(approach=APPROACH),
        criteria=c2d.SeizureCriteria(intrusion_depth=criterion),
    )
    assert c2d.Simulation(scenario).intrusions()["depth"] == pytest.approx([height])


def test_the_criterion_must_leave_room_inside_every_wheel() -> None:
    scenario = Scenario(
        ROBOT.with_track(c2d.CircumferentialWheels(24, wheel_radius=0.01)),
        c2d.terrains.step(0.05),
        criteria=c2d.SeizureCriteria(intrusion_depth=0.01),
    )
    with pytest.raises(c2d.ScenarioError, match=r"^criteria\.intrusion_depth must be less than"):
        scenario.validate()
