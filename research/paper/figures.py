"""The paper's eq. (1) and Figs. 1 to 14, from models and from runs that stopped."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

import crawler2d as c2d
from crawler2d.drawings.palette import BLACK, BLUE, ORANGE
from crawler2d.drawings.scene import Scene
from crawler2d.parameters.track import Track
from crawler2d.sweeps.figure_dataset import FigureDataset
from research.figures import join_legends, make_panels
from research.models import study_robot
from research.paper import CWA_ROUND, LWA_ROUND, TABLE_1
from research.paper.design import READINGS, Work, layouts
from research.tables import markdown_table, mm

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_GEAR = c2d.GearWheel()
_SMALL = c2d.CircumferentialWheels(16, wheel_radius=0.02, wheel=_GEAR)
_PHASED: dict[str, Track] = {
    **{f"line of {count}": c2d.LineOfWheels(count, wheel=_GEAR) for count in (2, 3, 4, 5, 9)},
    **{f"{count} all round": replace(_SMALL, count=count) for count in (16, 24)},
}
"""Gears whose angles are compared with the formula, as are those of the flippers."""

_SHAKEN = tuple((count, fraction) for count in (3, 5) for fraction in (0.0, 1.0 / 3.0, 0.5))
"""Number of wheels in a line, and phase fraction: in step, as in eq. (1), or a half."""

# [s] Time until the speed is steady, and duration of the measurement: 17 pitches at 0.4 m/s.
_STEADY, _LOOK = 3.0, 2.0
# [m] Corners at the same distance from the axle are this close to one circle.
_SAME = 1e-9

_COLUMNS = 3
_STUCK = {4: LWA_ROUND, 5: CWA_ROUND}
"""The figures that runs represent, with the row of the paper for each."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Phase:
    """The starting angles of the gears of one robot, compared with eq. (1)."""

    model: str
    count: int
    """Number of gears of one side, with those of the flipper."""
    off: float
    """[rad] Largest difference from the formula."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Shaking:
    """Vibration of the robot on a line of gears on level ground at a steady speed."""

    count: int
    fraction: float
    """[-] Fraction of the angle between two grousers, from wheel to wheel: a third in eq. (1)."""
    swing: float
    """[m] Range of the height of the chassis."""
    rocking: float
    """[rad] Range of the angle of the chassis."""
    vibration: float
    """[m/s^2] Vertical acceleration over the whole run, root mean square."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stuck:
    """A run that represents a figure of the paper."""

    figure: int
    model: str
    where: str
    """Setting and obstacle, in words."""
    run: c2d.Run
    """The run with its history."""

    @property
    def file(self) -> str:
        """The name of its page."""
        return f"figure_{self.figure}.html"


class Drawing(NamedTuple):
    """A figure of the paper that is drawn from a model."""

    number: int
    caption: str
    track: Track
    view: str = "robot"
    """"robot", "wheel" for only its rearmost wheel, or "angle" for the same with theta."""


def _drawings() -> tuple[Drawing, ...]:
    track = {name: layout.track for name, layout in layouts().items()}
    gears = track["line of 3 gears"]
    return (
        Drawing(1, "line of wheels that overlap", track["line of 5"]),
        Drawing(2, "line of wheels that touch", track["line of 4, touching"]),
        Drawing(3, "line of wheels with broad spaces", track["line of 3"]),
        Drawing(6, "small wheels, tightly packed", track["24 all round"]),
        Drawing(7, "small wheels with spaces", track["16 all round, spaced"]),
        Drawing(8, "wheels of varying sizes (b)", track["hybrid"]),
        Drawing(9, "chain of shoes on a guide", track["chain of 22 shoes"]),
        Drawing(10, "chain of shoes round a sprocket", c2d.SegmentalTrack(mechanism="sprocket")),
        Drawing(11, "single gear wheel", gears, "wheel"),
        Drawing(12, "small gears all round", track["16 gears all round, spaced"]),
        Drawing(13, "line of large gears", gears),
        Drawing(14, "the angle theta of eq. (1)", gears, "angle"),
    )


DRAWINGS = _drawings()

_OTHER_FIGURES = {
    "4": "a run of the simulator; here a replay of a line of large wheels that seizes",
    "5": "a run of the simulator; here a replay of small wheels that seize",
    "8 (a)": "a photograph of another robot, the Talon; its model is that of (b)",
    "15 to 17, 19": "pictures of runs of the simulator; those of Table 2 are runs here",
    "18": "photographs of the real robot",
}
"""Contents of the other figures."""


def phases(work: Work) -> list[Phase]:
    """Compare the starting angles of all gears with those of the formula."""
    robot = study_robot("built")
    runs = _runs([robot.with_track(track) for track in _PHASED.values()], work)
    return [
        Phase(model=model, count=len(gears), off=max(off_formula(*gear) for gear in gears))
        for model, run in zip(_PHASED, runs, strict=True)
        for gears in [gear_angles(run)]
    ]


def off_formula(number: int, angle: float, pitch: float) -> float:
    """[rad] Return the deviation of an angle from eq. (1), x = theta / 3 n, up to whole grousers.

    Examples
    --------
    >>> round(off_formula(4, 0.1 + 1.0 / 3.0, 1.0), 3)
    0.1
    """
    turns = (angle - pitch / 3.0 * number) / pitch
    return abs(turns - round(turns)) * pitch


def gear_angles(run: c2d.Run) -> list[tuple[int, float, float]]:
    """Find the angles of all gears from their outlines at the start.

    Returns
    -------
    list of tuple of int, float and float
        For each gear its number n, counted from 1 at the rear on the chassis and on the flipper,
        and the angle of a grouser and theta of eq. (1), as below.
    """
    gears: list[tuple[int, float, float]] = []
    numbers: Counter[str] = Counter()
    columns = (run.bodies[name] for name in ("kind", "carrier", "outline"))
    for kind, carrier, outline in zip(*columns, strict=True):
        if kind == c2d.BodyKind.WHEEL and len(outline):
            numbers[carrier] += 1
            gears.append((numbers[carrier], *_grouser_angle(outline)))
    return gears


def shaking(work: Work) -> list[Shaking]:
    """Drive lines of gears over level ground."""
    tracks = [
        c2d.LineOfWheels(count, wheel=c2d.GearWheel(phase_fraction=fraction))
        for count, fraction in _SHAKEN
    ]
    robot = study_robot()
    runs = _runs([robot.with_track(track) for track in tracks], work)
    return [
        Shaking(
            count=count,
            fraction=fraction,
            swing=float(np.ptp(run.position[run.time > _STEADY, 1])),
            rocking=float(np.ptp(run.chassis_angle[run.time > _STEADY])),
            vibration=run.metrics["vertical_acceleration"],
        )
        for (count, fraction), run in zip(_SHAKEN, runs, strict=True)
    ]


def equation_text(phases: Sequence[Phase], shaken: Sequence[Shaking]) -> str:
    """Compare the gears' starting angles with eq. (1), and write how much they shake."""
    count = 2 * sum(phase.count for phase in phases)
    off = max(phase.off for phase in phases)
    table = [
        (
            str(row.count),
            f"{row.fraction:.3f}",
            f"{1e3 * row.swing:.2f}",
            f"{math.degrees(row.rocking):.2f}",
            f"{row.vibration:.2f}",
        )
        for row in shaken
    ]
    head = ("gears", "phase fraction", "swing [mm]", "rocking [deg]", "vibration [m/s^2]")
    return "\n\n".join(
        (
            f"The starting angles of {count} gears, of {len(phases)} robots with their flippers,"
            f" are those of eq. (1) within {off:.0e} rad (up to whole grousers).",
            "Lines of gears on level ground at 0.4 m/s, no flippers: how far the chassis goes up"
            " and down and to and fro, and its vertical acceleration, root mean square.",
            markdown_table(head, table),
        )
    )


def stuck_runs(tables: Mapping[str, FigureDataset]) -> list[Stuck]:
    """Choose for each figure the first run that seized with an edge between two wheels.

    Parameters
    ----------
    tables : mapping of str to FigureDataset
        Runs over the parallelepiped of Table 3, by setting, with the dimensions `model`, `height`
        and `repeat`: a sharp corner on level ground, as in the figures.

    Returns
    -------
    list of Stuck
        From the first setting with such a run, at the lowest height, the first repeat. Figures
        without such a run are left out.
    """
    models = {reading.row: reading.layout for reading in READINGS}
    stuck = []
    for number, row in _STUCK.items():
        for setting, table in tables.items():
            own = table.sel(model=models[row]).transpose("height", "repeat", ...)
            held = (own["outcome"] == "seized") & (own["stop_carrier"] == "chassis")
            places = np.argwhere(held.to_numpy())
            if places.size:
                height, repeat = places[0]
                one = own.isel(height=height, repeat=repeat)
                run = c2d.simulate(c2d.Scenario.from_json(one["scenario"].item()))
                where = f"{setting}, block of {mm(one['height'].item())} mm"
                stuck.append(Stuck(figure=number, model=models[row], where=where, run=run))
                break
    return stuck


def write_stuck(stuck: Sequence[Stuck], folder: Path) -> None:
    """Write each run as a page that replays it."""
    folder.mkdir(parents=True, exist_ok=True)
    for each in stuck:
        each.run.to_html(folder / each.file)


def plot_layouts() -> Figure:
    """Draw the layouts of the figures, one panel each, without flippers."""
    rows = -(-len(DRAWINGS) // _COLUMNS)
    figure, axes = make_panels(rows, _COLUMNS, (4.6 * _COLUMNS, 2.7 * rows))
    for ax, drawn in zip(axes.flat, DRAWINGS, strict=True):
        robot = study_robot(track=drawn.track)
        if drawn.view == "robot":
            robot.plot(ax)
        else:
            _draw_wheel(ax, robot, with_angle=drawn.view == "angle")
        ax.set_title(f"Fig. {drawn.number}: {drawn.caption}", loc="left", fontsize="medium")
        ax.set(xlabel="", ylabel="")
    join_legends(figure, axes.ravel().tolist())
    figure.suptitle("The paper's figures as models of the Engineer, in its chassis frame [m]")
    return figure


def plot_stuck(stuck: Sequence[Stuck]) -> Figure:
    """Draw the ends of the runs that represent Figs. 4 and 5, one panel each."""
    figure, axes = make_panels(1, len(stuck), (6.5 * len(stuck), 4.2))
    for ax, each in zip(axes.flat, stuck, strict=True):
        run = each.run
        run.plot(ax, time=run.time[-1], trials=False)
        ax.set_title(f"Fig. {each.figure}: {each.model}, {each.where}", loc="left")
        x, y = run.position[-1]
        ax.set(xlim=(x - 0.35, x + 0.65), ylim=(y - 0.25, y + 0.4))
    join_legends(figure, axes.ravel().tolist())
    return figure


def figures_text(stuck: Sequence[Stuck], folder: str) -> str:
    """List the figures that are drawn, those replayed from a folder, and the others."""
    rows = [(str(each.number), each.caption, "drawn") for each in DRAWINGS]
    replayed = {str(each.figure): f"replayed in `{folder}/{each.file}`" for each in stuck}
    rows += [(number, what, replayed.get(number, "")) for number, what in _OTHER_FIGURES.items()]
    diagnoses = [
        f"Fig. {each.figure}, {each.model}, {each.where}: {each.run.diagnosis}" for each in stuck
    ]
    table = markdown_table(
        ("figure", "what it shows", "here"),
        sorted(rows, key=lambda row: int(row[0].split()[0])),
    )
    return "\n\n".join((table, *diagnoses))


def _runs(robots: list[c2d.Robot], work: Work) -> list[c2d.Run]:
    drive, ground = c2d.Drive(speed=TABLE_1.max_speed), c2d.terrains.flat()
    duration = _STEADY + _LOOK  # too short to reach the goal, where a run would end
    scenarios = [c2d.Scenario(robot, ground, drive=drive, duration=duration) for robot in robots]
    return c2d.simulate_many(scenarios, threads=work.threads, progress=False)


def _grouser_angle(outline: ArrayLike) -> tuple[float, float]:
    """Find the angle of a grouser and theta of eq. (1) from the outline of a gear.

    Parameters
    ----------
    outline : array_like, shape (n, 2)
        [m] Corners relative to the axle; those at the tips, two per grouser, are the farthest.

    Returns
    -------
    tuple of 2 floats
        [rad] Angle from the x axis to the middle of a grouser, up to whole grousers; and theta,
        from one grouser to the next.
    """
    corners = np.asarray(outline)
    far = np.hypot(*corners.T)
    tips = corners[far > far.max() - _SAME]
    grousers = len(tips) // 2
    angles = np.arctan2(tips[:, 1], tips[:, 0])
    middle = float(np.angle(np.mean(np.exp(1j * grousers * angles)))) / grousers
    return middle, 2.0 * math.pi / grousers


def _draw_wheel(ax: Axes, robot: c2d.Robot, *, with_angle: bool) -> None:
    """Draw only the rearmost wheel; mark the angle between two of its grousers."""
    scene = Scene.of_robot(c2d.Scenario(robot, c2d.terrains.flat()).to_json())
    x, radius = -0.5 * robot.outline.axle_distance, robot.outline.rear_radius
    wheel = scene.outline(0, 0) - (x, 0.0)
    ax.fill(*wheel.T, facecolor="none", edgecolor=BLACK, linewidth=1.2)
    ax.plot(0.0, 0.0, "o", color=BLACK, markersize=3.0)
    ax.set_aspect("equal")
    ax.set(xlim=(-2.0 * radius, 2.0 * radius), ylim=(-1.2 * radius, 1.2 * radius))
    if not with_angle:
        return
    first, theta = _grouser_angle(wheel)
    arc = first + theta * np.linspace(0.0, 1.0, 41)
    for angle in (first, first + theta):
        ax.plot((0.0, radius * np.cos(angle)), (0.0, radius * np.sin(angle)), color=BLUE)
    ax.plot(0.5 * radius * np.cos(arc), 0.5 * radius * np.sin(arc), color=ORANGE)
    middle, reach = first + 0.5 * theta, 0.64 * radius
    x, y = reach * np.cos(middle), reach * np.sin(middle)
    ax.text(x, y, "\u03b8", color=ORANGE, fontsize=13, ha="center", va="center")
