"""Pictures: what is drawn where; whether it is beautiful is for people to judge."""

from typing import Any

import matplotlib as mpl
import numpy as np
import pytest

import crawler2d as c2d
from conftest import POINTS, ROBOT

mpl.use("Agg")
from matplotlib import pyplot as plt


@pytest.fixture(autouse=True)
def _close() -> Any:
    yield
    plt.close("all")


def test_a_plot_has_a_side_view_and_three_strips(run: c2d.Run) -> None:
    side, angle, speed, force = run.plot()
    assert side.get_xlabel() == "x [m]"
    assert "[deg]" in angle.get_ylabel()
    assert "[m/s]" in speed.get_ylabel()
    assert "[N]" in force.get_ylabel()
    assert force.get_xlabel() == "time [s]"
    assert "cleared" in side.get_title(loc="left")
    side.figure.canvas.draw()


def test_the_side_view_shows_the_whole_path(run: c2d.Run) -> None:
    side = run.plot()[0]
    left, right = side.get_xlim()
    bottom, top = side.get_ylim()
    x, y = run.position.T
    assert left < x.min() < x.max() < right
    assert bottom < y.min() < y.max() < top
    assert side.get_aspect() == 1.0


def test_one_axes_takes_the_side_view_alone(run: c2d.Run) -> None:
    _, ax = plt.subplots()
    assert run.plot([0.0, 1.0], axes=ax) == (ax,)
    assert ax.get_lines()


def test_four_axes_of_the_caller_are_used(run: c2d.Run) -> None:
    _, axes = plt.subplots(4, 1)
    assert run.plot(1.0, axes=axes) == tuple(axes)
    assert all(ax.get_lines() for ax in axes)


def test_another_number_of_axes_is_refused(run: c2d.Run) -> None:
    _, axes = plt.subplots(2, 1)
    with pytest.raises(c2d.ScenarioError, match="one Axes or four"):
        run.plot(axes=tuple(axes))


@pytest.mark.parametrize(
    ("track", "terrain"),
    [
        (c2d.BeltTrack(), c2d.terrains.ramp(0.3, edge_radius=0.02)),
        (c2d.ForceTrack(), c2d.terrains.step(0.1)),
        (c2d.LineOfWheels(5), c2d.terrains.from_points(POINTS, goal=0.0)),
    ],
    ids=["belt", "skids that stop", "wheels"],
)
def test_every_kind_of_robot_and_ground_is_drawn(track: Any, terrain: Any) -> None:
    side = c2d.simulate(ROBOT.with_track(track), terrain).plot()[0]
    side.figure.canvas.draw()


def test_a_run_of_one_sample_is_drawn() -> None:
    run = c2d.simulate(ROBOT, c2d.terrains.flat(), duration=0.0, gravity=0.0)
    with np.errstate(all="raise"):
        assert len(run.plot()) == 4
