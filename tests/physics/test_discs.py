"""Wheels and grousers all round discs, against an independent walk round arcs and tangents."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d import _core
from crawler2d.parameters.scenario import Scenario
from tests.shared import ROBOT, TRAPEZOID

# In the direction of belt travel, from the disc at the rear of the lower run on.
TRAVELLED = {
    "trapezoid": [TRAPEZOID.outline.discs[i] for i in (1, 0, 3, 2)],
    "triangle": [(-0.2, 0.0, 0.06), (0.05, 0.2, 0.05), (0.2, 0.0, 0.06)],
    "square": [(-0.2, 0.0, 0.06), (-0.2, 0.3, 0.06), (0.2, 0.3, 0.06), (0.2, 0.0, 0.06)],
    "with a roller on top": [
        (-0.15, 0.0, 0.06),
        (-0.25, 0.1, 0.06),
        (0.0, 0.15, 0.045),
        (0.25, 0.1, 0.06),
        (0.15, 0.0, 0.06),
    ],
}
# Rounding of a walk of 2 m.
EXACTLY = 1e-12


def on(discs: Any, track: Any) -> c2d.Robot:
    outline = dataclasses.replace(ROBOT.outline, discs=discs)
    return dataclasses.replace(ROBOT, outline=outline, moment_of_inertia=1.0, track=track)


class Loop:
    """The taut belt round discs that it passes in this order: on each an arc, then a run."""

    def __init__(self, discs: list[tuple[float, float, float]]) -> None:
        self.discs = discs
        count = len(discs)
        self.runs, self.normals = [], []
        for i in range(count):
            (ax, ay, a), (bx, by, b) = discs[i], discs[(i + 1) % count]
            apart = math.hypot(bx - ax, by - ay)
            # The outside is to the left of belt travel; a smaller disc turns the tangent inwards.
            along = math.atan2(by - ay, bx - ax) - math.asin((a - b) / apart)
            self.normals.append(along + 0.5 * math.pi)
            self.runs.append(math.sqrt(apart**2 - (a - b) ** 2))
        before = [self.normals[i - 1] for i in range(count)]
        ends = zip(before, self.normals, strict=True)
        self.turns = [(start - end) % (2.0 * math.pi) for start, end in ends]

    @property
    def length(self) -> float:
        arcs = [disc[2] * turn for disc, turn in zip(self.discs, self.turns, strict=True)]
        return sum(arcs) + sum(self.runs)

    def at(self, way: float) -> tuple[float, float]:
        """[m] The point at a distance from the rear end of the lower run."""
        for i, (x, y, radius) in enumerate(self.discs):
            arc, start = radius * self.turns[i], self.normals[i - 1]
            if way < arc:
                angle = start - way / radius
                return x + radius * math.cos(angle), y + radius * math.sin(angle)
            way -= arc
            angle = self.normals[i]
            if way < self.runs[i]:
                place = np.array([x, y]) + radius * np.array([math.cos(angle), math.sin(angle)])
                right, up = place + way * np.array([math.sin(angle), -math.cos(angle)])
                return float(right), float(up)
            way -= self.runs[i]
        return self.at(way)


@pytest.mark.parametrize("discs", TRAVELLED.values(), ids=TRAVELLED)
@pytest.mark.parametrize("radius", [0.012, 0.025])
def test_spaced_wheels_sit_at_equal_ways_round_the_discs(discs: Any, radius: float) -> None:
    inside = Loop([(x, y, r - radius) for x, y, r in discs])
    for count in (3, 8, 24, 41):
        robot = on(discs, c2d.CircumferentialWheels(count, wheel_radius=radius))
        wheels = robot.wheels()
        left = wheels["side"] == "left"
        found = np.column_stack([wheels["x"], wheels["y"]])[left]
        expected = [inside.at(inside.length * i / count) for i in range(count)]
        assert found == pytest.approx(np.array(expected), abs=EXACTLY), count


@pytest.mark.parametrize("discs", TRAVELLED.values(), ids=TRAVELLED)
def test_tight_wheels_touch_their_neighbours_and_the_outline(discs: Any) -> None:
    wheels = on(discs, c2d.CircumferentialWheels(48)).wheels()
    left = wheels["side"] == "left"
    places = np.column_stack([wheels["x"], wheels["y"]])[left]
    radius = float(wheels["radius"][0])
    apart = np.linalg.norm(places - np.roll(places, -1, axis=0), axis=1)
    assert apart == pytest.approx([2.0 * radius] * 48, abs=EXACTLY)
    angles = np.concatenate([np.linspace(0.0, 2.0 * np.pi, 20_001), Loop(discs).normals])
    normals = np.column_stack([np.cos(angles), np.sin(angles)])
    support = np.max([normals @ (x, y) + r for x, y, r in discs], axis=0)
    depths = (support - places @ normals.T).min(axis=1)
    # The nearest of so many tangents to an arc.
    assert depths == pytest.approx([radius] * 48, abs=1e-8)


@pytest.mark.parametrize("discs", TRAVELLED.values(), ids=TRAVELLED)
def test_grousers_are_the_whole_number_nearest_to_the_pitch_on_the_roots(discs: Any) -> None:
    outline = ROBOT.outline
    roots = Loop([(x, y, r - outline.grouser_height) for x, y, r in discs])
    count = round(roots.length / outline.grouser_pitch)
    belt = on(discs, c2d.GrouserBeltTrack())
    bodies = _core.geometry(Scenario(belt, c2d.terrains.flat()).to_json())["bodies"]
    assert np.count_nonzero(np.equal(bodies["kind"], c2d.BodyKind.GROUSER)) == count
    chain = on(discs, c2d.SegmentalTrack())
    bodies = _core.geometry(Scenario(chain, c2d.terrains.flat()).to_json())["bodies"]
    assert np.count_nonzero(np.equal(bodies["kind"], c2d.BodyKind.SHOE)) == count


@pytest.mark.parametrize("track", [c2d.BeltTrack(), c2d.GrouserBeltTrack(), c2d.SegmentalTrack()])
def test_it_drives_up_a_ramp_that_its_raised_nose_meets(track: Any) -> None:
    run = c2d.simulate(Scenario(TRAPEZOID.with_track(track), c2d.terrains.ramp(0.4)))
    assert run.outcome == "cleared"
    assert run.metrics["max_angle"] == pytest.approx(0.4, abs=0.1)


@pytest.mark.parametrize("track", [c2d.BeltTrack(), c2d.ClosedTrack(c2d.CircumferentialWheels(40))])
@pytest.mark.parametrize("x", [-0.25, 0.0, 0.27])
def test_it_starts_on_ground_that_stands_under_any_of_its_runs(track: Any, x: float) -> None:
    place = -0.435 + x  # with its nose at -0.1 m
    spike = [(place - 0.005, 0.0), (place, 0.1), (place + 0.005, 0.0)]
    points = [(-3.0, 0.0), *spike, (0.0, 0.0), (0.0, 0.01), (3.0, 0.01)]
    ground = c2d.terrains.from_points(points, goal=0.0)
    robot = dataclasses.replace(TRAPEZOID.with_track(track), belly=None)
    start = c2d.Start(approach=0.1)
    run = c2d.simulate(Scenario(robot, ground, start=start, duration=0.01))
    # It touches the tip of the spike and falls from there.
    assert run.position[0, 1] > 0.08
    assert run.metrics["max_penetration"] < 1e-5


def test_a_closed_track_runs_round_the_wheels_on_discs() -> None:
    wheels = c2d.CircumferentialWheels(40)
    closed = on(TRAVELLED["trapezoid"], c2d.ClosedTrack(wheels))
    belt = on(TRAVELLED["trapezoid"], c2d.BeltTrack())
    shapes = [
        _core.geometry(Scenario(robot, c2d.terrains.flat()).to_json())["carriers"][0]["envelope"]
        for robot in (closed, belt)
    ]
    # Wheels fill the outline except for the corners between them.
    for low, high in zip(*([s.min(axis=0), s.max(axis=0)] for s in shapes), strict=True):
        assert low == pytest.approx(high, abs=5e-3)
