"""Two lanes: the ground of each track and the belly, in tables, rates and refusals."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d import _core
from crawler2d.parameters.scenario import Scenario
from crawler2d.sweeps.statistics import newcombe

# Heights at which some robots clear and some do not, without rotors.
ENGINEER = c2d.robots.engineer(flippers=None).without_rotors()
SIDES = {"both": 0, "left": 1, "right": 2, "middle": 3}


def geometry(terrain: Any) -> dict[str, Any]:
    return _core.geometry(Scenario(ENGINEER, terrain).to_json())


def lanes_of(terrain: Any) -> dict[int, np.ndarray[Any, Any]]:
    return dict(geometry(terrain)["lanes"])


def test_equal_lanes_are_one_and_a_belly_can_have_its_own() -> None:
    step, flat = c2d.terrains.step(0.05), c2d.terrains.flat()
    assert set(lanes_of(c2d.terrains.lanes(step, step))) == {SIDES["both"]}
    assert set(lanes_of(c2d.terrains.lanes(step, step, middle=step))) == {SIDES["both"]}
    own = lanes_of(c2d.terrains.lanes(step, step, middle=flat))
    assert set(own) == {SIDES["both"], SIDES["middle"]}
    assert own[SIDES["middle"]][:, 1].max() == 0.0
    apart = lanes_of(c2d.terrains.lanes(step, flat))
    assert set(apart) == {SIDES["left"], SIDES["right"], SIDES["middle"]}
    # The belly meets the higher of the two.
    assert np.array_equal(apart[SIDES["middle"]], apart[SIDES["left"]])


@pytest.mark.parametrize("yaw", [-0.6, 0.0, 0.4])
def test_a_diagonal_barrier_is_met_as_its_turn_says(yaw: float) -> None:
    barrier = c2d.terrains.diagonal_barrier(yaw, height=0.04, thickness=0.03)
    made = geometry(barrier)
    fronts = {
        int(lane): made["edges"]["x"][made["edges"]["lane"] == lane].min()
        for lane in np.unique(made["edges"]["lane"])
    }
    apart = ENGINEER.gauge * math.tan(yaw)
    if yaw == 0.0:
        assert fronts == {SIDES["both"]: 0.0}
    else:
        assert fronts[SIDES["right"]] - fronts[SIDES["left"]] == pytest.approx(apart)
    assert min(fronts.values()) == 0.0
    assert made["goal"] == pytest.approx(abs(apart) + 0.03 / math.cos(yaw))


def test_a_seed_alone_says_how_high_the_posts_are() -> None:
    def heights(seed: int, **fields: Any) -> list[float]:
        return [
            float(lane[:, 1].sum())
            for lane in lanes_of(c2d.terrains.random_stepfield(seed, **fields)).values()
        ]

    assert heights(1) == heights(1)
    assert heights(1) != heights(2)
    assert heights(1, rise=0.05) == pytest.approx([2.0 * h for h in heights(1)])
    field = c2d.terrains.stepfield_with_barrier(1, height=0.2, yaw=0.3)
    tops = [lane[:, 1].max() for lane in lanes_of(field).values()]
    assert tops == [0.2, 0.2, 0.2]


@pytest.mark.parametrize("pattern", ["flat", "hill", "diagonal"])
@pytest.mark.parametrize("fields", [{}, {"rise": 0.05}, {"levels": 2}])
def test_the_barrier_of_a_field_stands_above_its_highest_post(
    pattern: Any, fields: dict[str, Any]
) -> None:
    for seed in range(5):
        posts = c2d.terrains.random_stepfield(seed, pattern=pattern, **fields)
        field = c2d.terrains.stepfield_with_barrier(seed, pattern=pattern, **fields)
        highest = max(lane[:, 1].max() for lane in lanes_of(posts).values())
        tops = [float(lane[:, 1].max()) for lane in lanes_of(field).values()]
        assert tops == [field.barrier_height] * 3
        assert field.barrier_height > 1.4 * highest
    assert c2d.terrains.stepfield_with_barrier().barrier_height == 0.15


def test_tables_name_the_lane() -> None:
    terrain = c2d.terrains.lanes(
        c2d.terrains.barrier(0.03, 0.05), c2d.terrains.flat(), middle=c2d.terrains.flat()
    )
    robot = ENGINEER.with_track(c2d.LineOfWheels(5))
    run = c2d.simulate(robot, terrain, duration=4.0)
    assert set(run.edges["lane"]) == {SIDES["left"]}
    assert set(run.contacts["lane"]) == {SIDES["left"], SIDES["right"]}
    wheels = {int(lane): set(run.contacts["body"][run.contacts["lane"] == lane]) for lane in (1, 2)}
    # The parts of the left track, then those of the right one.
    assert wheels[1] <= set(range(5))
    assert wheels[2] <= set(range(5, 10))
    assert run.drive_speeds.shape[1] == 2
    inside = run.events["kind"] == "intrusion"
    assert inside.any()
    assert set(run.events["lane"][inside]) == {SIDES["left"]}


def test_a_stop_on_one_lane_is_seized_there() -> None:
    robot = ENGINEER.with_track(c2d.LineOfWheels(3, wheel_radius=0.05))
    blade = c2d.terrains.knife_edge(0.03, friction=0.5)
    flat = c2d.terrains.flat(friction=0.5)
    stop = c2d.simulate(robot, c2d.terrains.lanes(blade, flat, middle=flat)).diagnosis
    assert stop is not None
    assert (stop.outcome, stop.mechanism) == ("seized", "undercut")
    assert set(stop.contacts["lane"]) == {SIDES["left"], SIDES["right"]}
    assert set(stop.contacts["lane"][stop.contacts["in_pocket"]]) == {SIDES["left"]}
    # A blade that reaches under the belly stops the robot there.
    across = c2d.simulate(robot, c2d.terrains.lanes(blade, flat))
    assert across.outcome == "hung_up"


def nearly(terrain: Any) -> c2d.terrains.lanes:
    """The same under both tracks, but minimally lower beyond everything on the right."""
    points = [tuple(point) for point in lanes_of(terrain)[0]]
    points[0], points[-1] = (-3.0, 0.0), (3.0, points[-1][1])
    further = [*points[:-1], (3.001, points[-1][1])]
    goal = geometry(terrain)["goal"]
    left, right = (
        c2d.terrains.from_points(line, goal=goal, friction=terrain.friction)
        for line in (points, further)
    )
    return c2d.terrains.lanes(left, right)


@pytest.mark.parametrize("count", [24, pytest.param(60, marks=pytest.mark.soak)])
@pytest.mark.parametrize(
    ("track", "height", "friction"),
    [
        (c2d.BeltTrack(), 0.052, 0.6),
        (c2d.LineOfWheels(3), 0.05, 0.6),
        (c2d.LineOfWheels(3, wheel=c2d.GearWheel()), 0.09, 0.9),
        (c2d.CircumferentialWheels(24), 0.07, 0.9),
        (c2d.ForceTrack(), 0.043, 0.9),
    ],
    ids=["belt", "line", "gears", "circumferential", "force"],
)
def test_lanes_that_are_alike_give_the_rates_of_one(
    track: Any, height: float, friction: float, count: int
) -> None:
    """At a height where some robots clear and some do not; approach and height drawn."""
    rng = np.random.default_rng(5)
    draws = list(zip(rng.uniform(0.05, 0.15, count), rng.uniform(0.95, 1.05, count), strict=True))

    def cleared(make: Callable[[Any], Any]) -> int:
        scenarios = [
            Scenario(
                ENGINEER.with_track(track),
                make(c2d.terrains.step(height * share, friction=friction)),
                start=c2d.Start(approach=approach),
                duration=10.0,
            )
            for approach, share in draws
        ]
        runs = c2d.simulate_many(scenarios, threads=2, record="summary")
        return sum(run.outcome == "cleared" for run in runs)

    one, two = cleared(lambda step: step), cleared(nearly)
    print(track.kind, one, two)
    assert count / 12 < one < 11 * count / 12
    _, low, high = newcombe(one, count, two, count)
    assert low <= 0.0 <= high, f"{one} and {two} of {count}"


def test_a_lane_of_two_lanes_is_refused_where_it_is_given() -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        c2d.terrains.lanes(c2d.terrains.flat(), c2d.terrains.diagonal_barrier(0.1))  # type: ignore[arg-type]
    assert caught.value.path == "terrain.right"


@pytest.mark.parametrize(
    ("terrain", "path"),
    [
        (c2d.terrains.diagonal_barrier(1.5), "terrain.yaw"),
        (c2d.terrains.diagonal_barrier(0.1, thickness=0.0), "terrain.thickness"),
        (c2d.terrains.random_stepfield(-1), "terrain.seed"),
        (c2d.terrains.random_stepfield(1, posts=0), "terrain.posts"),
        (c2d.terrains.random_stepfield(1, pattern="steep"), "terrain.pattern"),  # type: ignore[arg-type]
        (c2d.terrains.random_stepfield(1, edge_radius=0.2), "terrain.edge_radius"),
        (c2d.terrains.stepfield_with_barrier(1, yaw=math.nan), "terrain.barrier_yaw"),
        (
            c2d.terrains.lanes(
                c2d.terrains.flat(),
                c2d.terrains.from_points([[200, 0], [300, 0]], goal=250.0),
            ),
            "terrain",
        ),
    ],
)
def test_lanes_that_cannot_be_are_refused_by_name(terrain: Any, path: str) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        c2d.simulate(ENGINEER, terrain)
    assert caught.value.path == path


def test_pictures_show_both_lanes() -> None:
    terrain = c2d.terrains.diagonal_barrier(0.5, height=0.03, thickness=0.04)
    run = c2d.simulate(ENGINEER.with_track(c2d.LineOfWheels(3)), terrain, duration=3.0)
    legend = run.plot().get_legend()
    assert legend is not None
    labels = [text.get_text() for text in legend.get_texts()]
    assert labels[:2] == ["ground of the left track", "ground of the right track"]
