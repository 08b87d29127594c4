"""Pictures: contents and positions; whether they are beautiful is for people to judge."""

from typing import Any

import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.text import Text

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from tests.pictures.reading import distance, lay_out
from tests.shared import GEAR, PLACEMENTS, POINTS, ROBOT, refused

WHEELS = ROBOT.with_track(c2d.LineOfWheels(4, wheel_radius=0.0608))


def test_a_plot_is_a_side_view_and_the_history_three_strips(run: c2d.Run) -> None:
    side = run.plot()
    assert (side.get_xlabel(), side.get_ylabel()) == ("x [m]", "y [m]")
    assert "cleared" in side.get_title(loc="left")
    angle, speed, force = run.plot_history()
    assert "[deg]" in angle.get_ylabel()
    assert "[m/s]" in speed.get_ylabel()
    assert "[N]" in force.get_ylabel()
    assert force.get_xlabel() == "time [s]"
    assert angle.get_title(loc="left") == run.title
    for ax in (side, angle):
        lay_out(ax)


def test_the_legend_of_the_history_covers_no_line(run: c2d.Run) -> None:
    _, speed, _ = run.plot_history()
    lay_out(speed)
    legend: Any = speed.get_legend()
    assert legend.get_window_extent().y0 >= speed.get_window_extent().y1
    assert [text.get_text() for text in legend.get_texts()][:3] == [
        "track",
        "chassis, along x",
        "commanded",
    ]


def test_the_side_view_shows_the_whole_path(run: c2d.Run) -> None:
    side = run.plot()
    left, right = side.get_xlim()
    bottom, top = side.get_ylim()
    x, y = run.position.T
    assert left < x.min() < x.max() < right
    assert bottom < y.min() < y.max() < top
    assert side.get_aspect() == 1.0


@pytest.mark.parametrize("name", ["$5", "a $ b $ c", "$\\frac{$", "\\$", "x_{$1^$", "100 %"])
def test_a_name_is_no_formula(scenario: Scenario, name: str) -> None:
    run = c2d.simulate(scenario.replace({"robot.name": name, "duration": 0.1}))
    side = run.plot()
    lay_out(side)
    title = next(text for text in side.findobj(Text) if text.get_text().startswith(name))
    assert not title.get_parse_math()


def test_a_plot_is_drawn_into_the_axes_it_is_given(run: c2d.Run) -> None:
    _, axes = plt.subplots(4, 1)
    assert run.plot(axes[0], time=[0.0, 1.0]) is axes[0]
    assert run.plot_history(axes[1:]) == tuple(axes[1:])
    assert all(ax.get_lines() for ax in axes)
    assert len(plt.get_fignums()) == 1


@pytest.mark.parametrize("ax", [1.0, [0.0, 1.0], "side"])
def test_anything_but_axes_is_refused(run: c2d.Run, ax: Any) -> None:
    error = refused(lambda: run.plot(ax))
    assert (error.path, error.rule) == ("ax", "must be an Axes of matplotlib")


def test_trials_of_a_plot_must_be_true_or_false(run: c2d.Run) -> None:
    given: Any = "no"
    assert refused(lambda: run.plot(trials=given)).path == "trials"


def test_another_number_of_axes_is_refused_for_the_history(run: c2d.Run) -> None:
    _, axes = plt.subplots(2, 1)
    assert refused(lambda: run.plot_history(axes)).path == "axes"
    assert refused(lambda: run.plot_history(axes[0])).path == "axes"
    wrong: Any = [axes[0], None, axes[1]]
    assert refused(lambda: run.plot_history(wrong)).path == "axes[1]"


def test_a_plot_without_a_history_leaves_no_open_figure() -> None:
    run = c2d.simulate(ROBOT, c2d.terrains.flat(), duration=0.2, record="summary")
    for draw in (run.plot, run.plot_history):
        with pytest.raises(AttributeError, match="no history"):
            draw()
    assert plt.get_fignums() == []


@pytest.mark.parametrize(
    ("track", "terrain"),
    [
        (c2d.BeltTrack(), c2d.terrains.ramp(0.3, edge_radius=0.02)),
        (c2d.ForceTrack(), c2d.terrains.step(0.1)),
        (c2d.LineOfWheels(5), c2d.terrains.from_points(POINTS, goal=0.0)),
        (c2d.HybridWheels(PLACEMENTS, wheel=GEAR), c2d.terrains.half_round(0.03)),
        (c2d.ForceTrack(support="wheels"), c2d.terrains.gap(0.1)),
    ],
    ids=["belt", "skids that stop", "wheels", "gears", "free wheels"],
)
def test_every_kind_of_robot_and_ground_is_drawn(track: Any, terrain: Any) -> None:
    side = c2d.simulate(ROBOT.with_track(track), terrain).plot()
    lay_out(side)


def test_gears_are_drawn_turned_as_far_as_they_have_run() -> None:
    track = c2d.CircumferentialWheels(24, wheel=c2d.GearWheel(grouser_count=8))
    run = c2d.simulate(ROBOT.with_track(track), c2d.terrains.step(0.06), duration=3.0)
    assert run.diagnosis is not None  # it stopped, so that its last contacts are those of its pose
    _, ax = plt.subplots()
    run.plot(ax, time=run.time[-1])
    black = [line for line in ax.get_lines() if line.get_color() == "#222222"]
    drawn = [np.array(line.get_xydata()) for line in black]
    gears = [outline for outline in drawn if len(outline) == 8 * 14 + 1]
    assert len(gears) == 24
    last = run.contacts["time"] == run.time[-1]
    places = np.column_stack([run.contacts["x"], run.contacts["y"]])[last]
    assert len(places) >= 2
    # A gear turned wrongly would miss its contacts by up to 5 mm, the height of its grousers.
    for place in places:
        assert min(distance(place, outline) for outline in gears) < 5e-5


def test_an_edge_inside_the_track_is_marked_and_named() -> None:
    run = c2d.simulate(WHEELS, c2d.terrains.step(0.1), duration=4.0)
    side, strips = run.plot(), run.plot_history()
    (mark,) = [line for line in side.get_lines() if "inside" in str(line.get_label())]
    assert np.array(mark.get_xydata()).tolist() == [[0.0, 0.1]]
    depth = 1e3 * run.metrics["intrusion_depth"]
    assert mark.get_label() == f"edge inside the envelope: {depth:.1f} mm, between wheels 1 and 2"
    shaded = [len(strip.patches) for strip in strips]
    assert shaded == [np.count_nonzero(run.events["kind"] == "stop")] * 3 == [1] * 3


@pytest.mark.parametrize("radius", [0.0, 0.03])
def test_an_edge_inside_the_track_is_marked_where_it_is_deepest_at_that_instant(
    radius: float,
) -> None:
    simulation = c2d.Simulation(c2d.Scenario(WHEELS, c2d.terrains.step(0.1, edge_radius=radius)))
    simulation.advance(1.75)
    inside = simulation.intrusions()
    simulation.advance(0.25)
    run = simulation.to_run()
    assert inside["depth"][0] < 0.9 * run.events["depth"].max()
    side = run.plot(time=1.75)
    (mark,) = [line for line in side.get_lines() if "inside" in str(line.get_label())]
    told = float(str(mark.get_label()).partition(": ")[2].partition(" mm")[0])
    assert told == pytest.approx(1e3 * inside["depth"][0], abs=0.1)
    # The points of the arc that are drawn are 3 mm apart.
    place = np.array(mark.get_xydata())
    assert np.allclose(place, [[inside["x"][0], inside["y"][0]]], rtol=0.0, atol=2e-3)


def labels(ax: Any) -> list[str]:
    return [str(artist.get_label()) for artist in (*ax.get_lines(), *ax.collections)]


def test_the_last_pose_has_its_contacts_with_a_stated_scale() -> None:
    run = c2d.simulate(WHEELS, c2d.terrains.step(0.1), duration=4.0)
    side = run.plot()
    last = run.contacts["time"] == run.time[-1]
    force = np.hypot(run.contacts["normal_force"], run.contacts["friction_force"])[last].max()
    speed = np.abs(run.contacts["surface_speed"][last]).max()
    forces, speeds = (
        next(c for c in side.collections if word in str(c.get_label()))
        for word in ("contact force", "slip velocity")
    )
    assert forces.get_label() == f"contact force, up to {force:.0f} N"
    assert speeds.get_label() == f"slip velocity, up to {speed:.2f} m/s"
    assert len(np.asarray(forces.get_offsets())) == np.count_nonzero(last)


def test_contacts_are_those_of_the_last_pose_that_is_drawn() -> None:
    run = c2d.simulate(WHEELS, c2d.terrains.step(0.1), duration=4.0)
    _, ax = plt.subplots()
    run.plot(ax, time=[0.0, 0.5])
    now = run.contacts["time"] == run.time[np.abs(run.time - 0.5).argmin()]
    (forces,) = [c for c in ax.collections if "contact force" in str(c.get_label())]
    assert np.allclose(np.asarray(forces.get_offsets())[:, 0], run.contacts["x"][now])
    assert not [label for label in labels(ax) if "inside" in label]


def test_the_belt_is_drawn_round_wheels_alone(run: c2d.Run) -> None:
    belt = c2d.simulate(ROBOT, c2d.terrains.flat(), duration=0.5)
    assert "envelope (taut belt round the wheels)" in labels(run.plot())
    assert "envelope (taut belt round the wheels)" not in labels(belt.plot())


def test_the_title_says_why_the_robot_stopped() -> None:
    run = c2d.simulate(WHEELS, c2d.terrains.step(0.1), duration=4.0)
    side = run.plot()
    title, *why = side.get_title(loc="left").splitlines()
    assert title == run.title
    assert " ".join(why) == str(run.diagnosis)
    # In a small picture, the sentence would fill everything.
    _, axes = plt.subplots(1, 3, figsize=(9.0, 4.0))
    assert run.plot(axes[1]).get_title(loc="left").replace("\n", " ") == run.title
    for ax in (side, axes[1]):
        (written,) = [text for text in ax.findobj(Text) if text.get_text().startswith(title[:20])]
        assert written.get_window_extent().width < ax.get_window_extent().width


def test_no_edge_is_marked_and_nothing_shaded_when_a_run_clears(run: c2d.Run) -> None:
    side, strips = run.plot(), run.plot_history()
    assert not [line for line in side.get_lines() if "inside" in str(line.get_label())]
    assert "intrusion" in run.events["kind"]
    assert not any(strip.patches for strip in strips)


def test_a_run_of_one_sample_is_drawn() -> None:
    run = c2d.simulate(ROBOT, c2d.terrains.flat(), duration=0.0, gravity=0.0)
    with np.errstate(all="raise"):
        assert run.plot().get_lines()
        assert len(run.plot_history()) == 3


@pytest.mark.parametrize("time", [float("nan"), float("inf"), "end", [], [[1.0]], True])
def test_an_instant_is_a_finite_number(run: c2d.Run, time: Any) -> None:
    for show in (run.plot, run.to_html, run.widget):
        with pytest.raises(c2d.ScenarioError, match=r"^time must be a number of seconds"):
            show(time=time)


def test_a_page_opens_at_one_instant(run: c2d.Run) -> None:
    several: Any = [0.5, 1.0]
    for show in (run.to_html, run.widget):
        with pytest.raises(c2d.ScenarioError, match=r"^time must be a number of seconds, got \["):
            show(time=several)


@pytest.mark.parametrize("time", [-1.0, 1e6])
def test_an_instant_is_within_the_run_give_or_take_how_titles_round(
    run: c2d.Run, time: Any
) -> None:
    for show in (run.plot, run.to_html, run.widget):
        with pytest.raises(c2d.ScenarioError, match=r"^time must be within the run, from 0\.00 to"):
            show(time=time)
        show(time=round(run.time[-1] + 0.005, 2))
