"""Side views of robots and scenarios: their contents and positions."""

import dataclasses
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.text import Text

import crawler2d as c2d
from crawler2d.drawings.scene import close_line, place, relative
from crawler2d.parameters.track import Track
from tests.pictures.reading import lay_out
from tests.shared import GEAR, ROBOT, TRAPEZOID, VARIANTS, refused

ROBOTS = {
    **{name: getattr(c2d.robots, name)() for name in c2d.robots.__all__},
    **{f"public {name}": getattr(c2d.robots, name)(track="public") for name in ("absolem", "marv")},
    **{name: scenario.robot for name, scenario in VARIANTS.items()},
    "a motor for each wheel": c2d.read_robot(c2d.samples.path()).robot,
    "unequal ends": dataclasses.replace(
        ROBOT, outline=dataclasses.replace(ROBOT.outline, front_radius=0.05)
    ),
}
# Some scenarios have the same robot on other ground.
ROBOTS = {
    name: robot
    for number, (name, robot) in enumerate(ROBOTS.items())
    if robot not in list(ROBOTS.values())[:number]
}


def words(ax: Any) -> list[Text]:
    """All texts: title, dimensions, legend, names of the axes and their ticks."""
    found = [*ax.texts, *ax.get_legend().get_texts(), ax.xaxis.label, ax.yaxis.label, title_of(ax)]
    for axis, limits, row in ((ax.xaxis, ax.get_xlim(), 0), (ax.yaxis, ax.get_ylim(), 1)):
        # Those beyond the limits are not drawn.
        found += [t for t in axis.get_ticklabels() if inside(t.get_position()[row], limits)]
    return [text for text in found if text.get_text()]


def title_of(ax: Any) -> Text:
    title: Text
    (title,) = [t for t in ax.findobj(Text) if t.get_text() == ax.get_title(loc="left")]
    return title


def inside(value: float, limits: tuple[float, float]) -> bool:
    return limits[0] <= value <= limits[1]


def lines(ax: Any) -> list[Any]:
    return [np.array(line.get_xydata()) for line in ax.get_lines()]


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
def test_every_robot_is_drawn_and_no_label_lies_over_another(robot: c2d.Robot) -> None:
    ax = robot.plot()
    lay_out(ax)
    assert ax.get_title(loc="left") == robot.description
    boxes = [(text.get_text(), text.get_window_extent()) for text in words(ax)]
    assert [(a, b) for (a, one), (b, two) in combinations(boxes, 2) if one.overlaps(two)] == []
    whole = ax.figure.bbox
    cut = [name for name, box in boxes if box.x0 < 0 or box.x1 > whole.x1]
    cut += [name for name, box in boxes if box.y0 < 0 or box.y1 > whole.y1]
    assert cut == []


@pytest.mark.parametrize("scenario", VARIANTS.values(), ids=VARIANTS)
def test_every_ground_is_drawn_with_the_robot_before_it_and_the_goal(scenario: Any) -> None:
    ax = scenario.plot()
    lay_out(ax)
    run = c2d.simulate(scenario, duration=0.0)
    x, y = run.position[0]
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    assert left < x < right
    assert bottom < y < top
    (goal,) = [line for line in ax.get_lines() if line.get_label() == "goal (rear end)"]
    assert left < np.asarray(goal.get_xdata())[0] < right


@pytest.mark.parametrize("name", ["flippers-climb", "line-barrier", "belt-step", "flippers-hold"])
def test_the_outlines_of_a_robot_lie_where_its_run_says(name: str) -> None:
    scenario = VARIANTS[name]
    run = c2d.simulate(scenario, duration=0.0)
    frame = np.array([[*run.position[0], run.chassis_angle[0]]])
    in_chassis, on_ground = lines(scenario.robot.plot()), lines(scenario.plot())
    near = [row for row, number in enumerate(run.bodies["body"]) if number >= 0]
    for row in near:
        outline, pose = close_line(run.bodies["outline"][row]), run.poses[0, row]
        (own,) = relative(pose[None], frame)
        assert any(same(line, place(outline, pose)) for line in on_ground)
        assert any(same(line, place(outline, own)) for line in in_chassis)


def same(one: Any, other: Any) -> bool:
    return one.shape == other.shape and bool(np.abs(one - other).max() < 1e-9)


def test_a_robot_shows_its_dimensions_and_its_centre_of_mass() -> None:
    robot = c2d.robots.engineer()
    ax = robot.plot()
    told = {text.get_text() for text in words(ax)}
    assert {"axle distance 0.365 m", "radius 0.064 m", "flipper 0.34 m"} <= told
    # The mass of the raised flippers is higher and farther back than at angle 0.
    (center,) = [line[0] for line in lines(ax) if line.shape == (1, 2)]
    assert 0.0 < center[0] < robot.center_of_mass[0]
    assert center[1] > robot.center_of_mass[1]
    bare = robot.without_flippers()
    (center,) = [line[0] for line in lines(bare.plot()) if line.shape == (1, 2)]
    assert center == pytest.approx(bare.center_of_mass, abs=1e-12)


def test_a_robot_on_discs_shows_every_axle_and_each_radius_once() -> None:
    ax = TRAPEZOID.plot()
    told = [text.get_text() for text in words(ax)]
    assert [text for text in told if text.startswith("axle")] == ["axle distance 0.57 m"]
    radii = sorted(text for text in told if text.startswith("radius"))
    assert radii == ["radius 0.045 m", "radius 0.05 m", "radius 0.064 m"]
    discs = np.array(TRAPEZOID.outline.discs)
    (axles,) = [line for line in lines(ax) if line.shape == (4, 2) and same(line, discs[:, :2])]
    (belt,) = [line for line in lines(ax) if len(line) > 100 and not inside_all(line, discs)]
    away = np.linalg.norm(belt[:, None] - axles, axis=2) - discs[:, 2]
    # On the hull of the discs: none reaches out, and the arcs lie on them.
    assert away.min() == pytest.approx(0.0, abs=1e-9)
    assert np.abs(away.min(axis=0)).max() < 1e-9


def inside_all(line: Any, discs: Any) -> bool:
    """Whether a line is the circle of one of the discs."""
    away = np.linalg.norm(line[:, None] - discs[:, :2], axis=2) - discs[:, 2]
    return bool((np.abs(away).max(axis=0) < 1e-9).any())


def test_the_track_as_built_is_drawn_where_the_model_leaves_it() -> None:
    models: list[tuple[Track, bool]] = [
        (c2d.BeltTrack(), False),
        (c2d.LineOfWheels(4), True),
        (c2d.SegmentalTrack(), True),
    ]
    for track, shown in models:
        labels = [line.get_label() for line in ROBOT.with_track(track).plot().get_lines()]
        assert ("track as built" in labels) == shown


@pytest.mark.parametrize(
    ("terrain", "told"),
    [
        (c2d.terrains.step(0.075), "0.075 m"),
        (c2d.terrains.barrier(0.05, 0.1), "0.05 m"),
        (c2d.terrains.stairs(), "0.8 m"),
        (c2d.terrains.gap(0.1, depth=0.3), "0.3 m"),
        (c2d.terrains.lanes(c2d.terrains.step(0.05), c2d.terrains.step(0.03)), "0.05 m"),
        (c2d.terrains.flat(), None),
    ],
)
def test_the_height_of_an_obstacle_can_be_read(terrain: Any, told: str | None) -> None:
    ax = c2d.Scenario(ROBOT, terrain).plot()
    heights = [text.get_text() for text in ax.texts if text.get_text().endswith(" m")]
    assert heights == ([] if told is None else [told])


@pytest.mark.parametrize("level", [0.3, -0.3])
def test_the_height_at_the_right_end_of_a_view_is_inside_of_it(level: float) -> None:
    slope = c2d.terrains.from_points([(-2.0, 0.0), (0.0, 0.0), (3.0, level)], goal=0.5)
    ax = c2d.Scenario(ROBOT, slope).plot()
    lay_out(ax)
    (label,) = (each for each in ax.texts if each.get_text().endswith(" m"))
    assert label.get_window_extent().x1 < ax.get_window_extent().x1


def test_both_are_drawn_into_the_axes_they_are_given() -> None:
    _, (one, other) = plt.subplots(1, 2)
    assert ROBOT.plot(one) is one
    assert VARIANTS["belt-step"].plot(ax=other) is other
    assert plt.get_fignums() == [1]
    assert refused(lambda: ROBOT.plot((one, other))).path == "ax"  # type: ignore[arg-type]


def test_a_broken_robot_is_refused_before_there_is_a_figure() -> None:
    broken = dataclasses.replace(ROBOT, mass=-1.0)
    assert refused(broken.plot).path == "robot.mass"
    assert refused(c2d.Scenario(broken, c2d.terrains.flat()).plot).path == "robot.mass"
    assert plt.get_fignums() == []


def test_a_title_says_what_the_tracks_are() -> None:
    named: dict[str, Track] = {
        "smooth belt": c2d.BeltTrack(),
        "belt with grousers": c2d.GrouserBeltTrack(),
        "4 gear wheels in a line": c2d.LineOfWheels(4, wheel=GEAR),
        "24 round wheels all round": c2d.CircumferentialWheels(24),
        "chain of shoes on a guide": c2d.SegmentalTrack(),
        "chain of shoes round a sprocket": c2d.SegmentalTrack(mechanism="sprocket"),
        "skids pushed by a force": c2d.ForceTrack(),
        "5 free wheels pushed by a force": c2d.ForceTrack(support="wheels"),
        "belt closed round 4 round wheels in a line": c2d.ClosedTrack(c2d.LineOfWheels(4)),
    }
    for told, track in named.items():
        assert ROBOT.with_track(track).description == f"engineer: {told}"
    assert c2d.robots.marv().description.endswith("; flippers: belt with grousers")


@pytest.mark.parametrize("name", ["$5", "$\\frac{$", "x_{$1^$"])
def test_a_name_is_no_formula_over_a_robot(name: str) -> None:
    robot = dataclasses.replace(ROBOT, name=name)
    for ax in (robot.plot(), c2d.Scenario(robot, c2d.terrains.flat()).plot()):
        lay_out(ax)
        assert ax.get_title(loc="left").startswith(name)
