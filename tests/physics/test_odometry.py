"""Travel of a track for a distance of its chassis, in closed form, without slip."""

import math
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.parameters.terrain import Points

# A rotor keeps a belt moving through an impact, so that it slips by 2 mm more on a ridge.
ENGINEER = c2d.robots.engineer(flippers=None).without_rotors()
RADIUS, AXLES = ENGINEER.outline.front_radius, ENGINEER.outline.axle_distance
BELT, GROUSERS, WHEELS = c2d.BeltTrack(), c2d.GrouserBeltTrack(), c2d.LineOfWheels(9)


def arc(radius: float, *, upwards: bool) -> Points:
    """A cap or a hollow with a radius [m], 1 rad long, in facets of 0.01 rad."""
    angles = np.linspace(-0.5, 0.5, 101)
    x = radius * (np.sin(angles) + math.sin(0.5))
    y = radius * (np.cos(angles) - math.cos(0.5)) * (1.0 if upwards else -1.0)
    points = np.vstack([[(-3.0, 0.0)], np.array([x, y]).T, [(x[-1] + 3.0, 0.0)]])
    points[[1, -2], 1] = 0.0
    return c2d.terrains.from_points(points, goal=float(x[-1]))


def between(track: Any, ground: Any, begin: float, end: float) -> tuple[float, float, float]:
    """Distances of track and chassis, and the turn, between two chassis angles."""
    drive = c2d.Drive(speed=0.1)
    run = c2d.simulate(ENGINEER.with_track(track), ground, drive=drive, duration=60.0)
    assert run.outcome == "cleared"
    sign = 1.0 if end > begin else -1.0
    first = np.flatnonzero(sign * run.chassis_angle < sign * begin)[-1]
    last = first + np.flatnonzero(sign * run.chassis_angle[first:] > sign * end)[0]
    span, angle = slice(first, last + 1), run.chassis_angle
    forward = run.velocity[:, 0] * np.cos(angle) + run.velocity[:, 1] * np.sin(angle)
    time = run.time[span]
    ways = (np.trapezoid(values[span], time) for values in (run.track_speed, forward))
    return (*(float(way) for way in ways), float(angle[last] - angle[first]))  # type: ignore[return-value]


@pytest.mark.parametrize("track", [BELT, GROUSERS, WHEELS], ids=lambda track: track.kind)
@pytest.mark.parametrize("radius", [0.5, 1.0])
def test_over_a_crest_the_track_runs_less_by_its_radius_times_the_turn(
    track: Any, radius: float
) -> None:
    """On the lower run, whose ground stands still: track = way + R x turn; the nose comes down."""
    run, way, turn = between(track, arc(radius, upwards=True), 0.25, -0.25)
    assert turn < -0.5
    # A sample is 1 mm of way, and the ends of wheels rock on facets.
    assert run - way == pytest.approx(RADIUS * turn, abs=1e-3)


@pytest.mark.parametrize("track", [BELT, WHEELS], ids=lambda track: track.kind)
@pytest.mark.parametrize("radius", [1.0, 2.0])
def test_in_a_hollow_a_smooth_track_runs_more_than_the_way(track: Any, radius: float) -> None:
    """Both ends roll inside a circle; the chassis between them is a chord closer to its centre."""
    run, way, _ = between(track, arc(radius, upwards=False), -0.25, 0.25)
    expected = radius / math.sqrt((radius - RADIUS) ** 2 - AXLES**2 / 4.0)
    assert run / way == pytest.approx(expected, rel=5e-4)  # facets of 0.01 rad


@pytest.mark.parametrize("radius", [1.0, 2.0])
def test_in_a_hollow_a_belt_with_grousers_reads_less_than_its_way(radius: float) -> None:
    """Round the ends tips are faster than the belt: at most as far as the polygon of their corners
    rolls while the belt runs a pitch."""
    ground = arc(radius, upwards=False)
    (run, way, _), (smooth_run, smooth_way, _) = (
        between(track, ground, -0.25, 0.25) for track in (GROUSERS, BELT)
    )
    outline = ENGINEER.outline
    belt_radius = outline.front_radius - outline.grouser_height
    corner = math.asin(0.5 * outline.grouser_thickness / RADIUS)
    gap = 2.0 * RADIUS * math.sin(0.5 * outline.grouser_pitch / belt_radius - corner)
    slowest = outline.grouser_pitch / (outline.grouser_thickness + gap)
    assert slowest == pytest.approx(1.0 / 1.2, rel=2e-3)  # "up to a fifth" of the conventions
    assert run < 0.98 * way
    assert slowest < (run / way) / (smooth_run / smooth_way) < 1.0


def test_over_a_ridge_a_belt_with_grousers_reads_25_mm_less_than_its_way() -> None:
    ridge, drive = c2d.terrains.ridge(0.03, 2.6), c2d.Drive(speed=0.1)
    found = {}
    for track in (BELT, GROUSERS):
        run = c2d.simulate(
            ENGINEER.with_track(track), ridge, drive=drive, duration=40.0, record="summary"
        )
        assert run.outcome == "cleared"
        found[track.kind] = run.metrics["track_distance"] - run.metrics["path_length"]
        assert run.metrics["path_length"] == pytest.approx(0.861, abs=2e-3)
    assert found["belt"] == pytest.approx(0.0, abs=2e-3)
    assert found["grouser_belt"] == pytest.approx(-0.025, abs=2e-3)
