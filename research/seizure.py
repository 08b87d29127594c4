"""The seizure study: which track models get the Engineer over an edge, how often, and why not."""

import math
import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import xarray

import crawler2d as c2d
from crawler2d.common.bodies import belly_corners
from research import models, stops
from research import seizure_tables as tables
from research.models import FRICTION, StudyModel, study_models, study_robot
from research.study import Job, Study
from research.tables import in_mm

_STRONG = "torque doubled"
"""Another robot whose gear wheels are compared with round ones."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Design:
    """The size of the study."""

    heights: Mapping[str, tuple[float, ...]]
    """[m] By obstacle: "step", "barrier", "knife edge"."""
    repeats: int
    """Runs per model, obstacle and height; 20 in the paper."""
    robot_heights: tuple[float, ...]
    """[m] Heights of the step for the other robots."""
    robot_repeats: int
    ride_repeats: int
    """Runs per model on flat ground."""
    phase_fractions: tuple[float, ...]
    """[-] Phase fractions of the gear wheels on flat ground."""


FULL = Design(
    heights={
        "step": (0.040, 0.060, 0.075, 0.090, 0.100, 0.125, 0.150),
        "barrier": (0.040, 0.060, 0.080, 0.100, 0.125),
        "knife edge": (0.020, 0.040, 0.060, 0.100),
    },
    repeats=20,
    robot_heights=(0.060, 0.090, 0.125),
    robot_repeats=5,
    ride_repeats=2,
    phase_fractions=tuple(twelfth / 12.0 for twelfth in range(13)),
)
QUICK = Design(
    heights={"step": (0.060, 0.100), "barrier": (0.060,), "knife edge": (0.040,)},
    repeats=3,
    robot_heights=(0.090,),
    robot_repeats=1,
    ride_repeats=1,
    phase_fractions=(0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0),
)


def _base() -> c2d.Scenario:
    return c2d.Scenario(study_robot(), models.obstacle("step", 0.1), drive=c2d.Drive(speed=0.4))


@dataclass(frozen=True, slots=True, kw_only=True)
class Sweeps:
    """The simulations of the study; each method runs one sweep, with the same draws.

    Parameters
    ----------
    design : Design
        How much to simulate.
    base : Scenario
        What all runs share; by default the Engineer without flippers.
    models : mapping of str to StudyModel
        The models; by default those of `study_models`.
    seed : int
        Seed of the draws.
    threads : int, optional
        See `simulate_many`.
    progress : bool
        Whether to show a progress bar.
    """

    design: Design = FULL
    base: c2d.Scenario = field(default_factory=_base)
    models: Mapping[str, StudyModel] = field(default_factory=study_models)
    seed: int = 0
    threads: int | None = None
    progress: bool = True

    def on_obstacle(self, obstacle: str) -> xarray.Dataset:
        """Run every model over one obstacle: track, height, repeat; makes trials of every stop."""
        heights = self.design.heights[obstacle]
        base = self.base.replace({"terrain": models.obstacle(obstacle, heights[0])})
        return self._sweep(base, {**self._tracks(), "terrain.height": heights}, self.design.repeats)

    def on_other_robots(self, names: Iterable[str] | None = None) -> xarray.Dataset:
        """Run every model of every robot over a step, with trials: robot, track, height, repeat.

        Parameters
        ----------
        names : iterable of str, optional
            Some of `study_robots`; None takes all.
        """
        robots = models.study_robots()
        over = {
            "robot": robots if names is None else {name: robots[name] for name in names},
            **self._tracks(),
            "terrain.height": self.design.robot_heights,
        }
        return self._sweep(self.base, over, self.design.robot_repeats)

    def on_the_flat(self) -> xarray.Dataset:
        """Run every model over flat ground: track, repeat."""
        return self._sweep(self._flat(), self._tracks(), self.design.ride_repeats)

    def over_phases(self) -> xarray.Dataset:
        """Run lines of gear wheels on the flat: robot_track_count, phase_fraction, repeat."""
        over = {
            "robot.track.count": [3, 4, 5],
            "robot.track.wheel.phase_fraction": self.design.phase_fractions,
        }
        base = self._flat().replace({"robot.track": c2d.LineOfWheels(3, wheel=c2d.GearWheel())})
        return self._sweep(base, over, self.design.ride_repeats)

    def _flat(self) -> c2d.Scenario:
        # With ten times the robot's acceleration, the speed is steady after 0.2 s, not 2 s.
        acceleration = 10.0 * self.base.robot.drivetrain.max_acceleration
        ground = c2d.terrains.flat(friction=FRICTION)
        return self.base.replace(
            {"terrain": ground, "robot.drivetrain.max_acceleration": acceleration}
        )

    def _tracks(self) -> dict[str, Any]:
        """Return the axis of models."""
        return {"robot.track": {name: model.track for name, model in self.models.items()}}

    def _sweep(self, base: c2d.Scenario, over: Mapping[Any, Any], repeats: int) -> xarray.Dataset:
        return c2d.sweep(
            base,
            over,
            repeats=repeats,
            seed=self.seed,
            threads=self.threads,
            progress=self.progress,
            on_error="record",
            trials=stops.TRIALS,
            wall_time=True,
        )


def header(sweeps: Sweeps) -> str:
    """Describe what is simulated, estimated and drawn."""
    base, design = sweeps.base, sweeps.design
    robot, outline = base.robot, base.robot.outline
    belly = belly_corners(robot.belly)[:, 1]
    clearance = outline.rear_radius + belly.min(initial=math.inf)
    build = ", ".join(f"{name} {value}" for name, value in c2d.build_info().items())
    obstacles = "; ".join(f"{name} {in_mm(h)} mm" for name, h in design.heights.items())
    return (
        f"Engineer without flippers, {len(sweeps.models)} track models: {obstacles}\n"
        f"barrier 100 mm thick, knife edge 10 mm; {design.repeats} repeats, seed {sweeps.seed}\n"
        f"build: {build}\n"
        f"estimates: mass {robot.mass} kg, centre of mass {robot.center_of_mass} m, "
        f"belly clearance {1e3 * clearance:.0f} mm,\n"
        f"  torque {robot.drivetrain.max_torque} N m per sprocket, "
        f"track mass {robot.track_mass} kg, "
        f"friction {getattr(base.terrain, 'friction', math.nan)}, speed {base.drive.speed} m/s\n"
        "drawn for each repeat, the same for every model: approach over a quarter of the axle\n"
        "  distance, track phase over a grouser pitch, speed and friction within 2 %"
    )


def _run_seizure(job: Job) -> None:
    begin = time.perf_counter()
    sweeps = Sweeps(design=FULL if job.full else QUICK, **job.sampling)
    runs, head = cross_obstacles(sweeps)
    climbs = [row for name, table in runs.items() for row in tables.climbs(table, name)]
    heights = tables.climbs_text(sweeps.models, climbs)
    print(f"\n{heights}", flush=True)

    robots, flat, turned = sweeps.on_other_robots(), sweeps.on_the_flat(), sweeps.over_phases()
    public = tables.public_wheel_model(sweeps.threads)
    endings = _report_stops(job, sweeps, runs, robots.sel(robot=_STRONG))
    took = time.perf_counter() - begin

    cells = [row for name, table in runs.items() for row in tables.cells(table, name)]
    others = [
        row
        for robot in robots["robot"].to_numpy().tolist()
        for row in tables.cells(robots.sel(robot=robot), "step", robot)
    ]
    rides, phases, posts = tables.rides(flat), tables.phases(turned), tables.posts(public)
    text = (
        tables.rates_text(cells),
        endings,
        tables.robots_text(others),
        tables.rides_text(rides),
        tables.phases_text(phases),
        tables.posts_text(posts),
        tables.paper_text(sweeps.models, climbs),
    )
    job.report("study", "\n\n\n".join(text), head, heights)
    for obstacle, table in runs.items():
        tables.write_runs(table, job.out / f"runs_{obstacle.replace(' ', '_')}.csv")
    job.write_rows(rates=[*cells, *others], heights=climbs, flat=rides, phases=phases, posts=posts)
    job.draw(
        {
            "rates": partial(tables.plot_rates, cells),
            "phases": partial(tables.plot_phases, phases),
            "posts": partial(tables.plot_posts, public),
        }
    )
    count = sum(table["outcome"].size for table in (*runs.values(), robots, flat, turned))
    print(f"{count + len(public)} runs in {took:.0f} s; tables and pictures are in {job.out}")
    if not job.full:
        print("This was a look at few heights; the whole study: make study ARGS=--full (minutes)")


def cross_obstacles(sweeps: Sweeps) -> tuple[dict[str, xarray.Dataset], str]:
    """Run every model over every obstacle; returns the runs, and the header, which is printed."""
    head = header(sweeps)
    print(head, flush=True)
    return {name: sweeps.on_obstacle(name) for name in sweeps.design.heights}, head


def _report_stops(
    job: Job, sweeps: Sweeps, runs: Mapping[str, xarray.Dataset], strong: xarray.Dataset
) -> str:
    """Write tables of why runs stopped, with replays; return the text."""
    endings = [row for name, table in runs.items() for row in stops.stops(table, name)]
    pairs = models.gear_pairs(sweeps.models)
    wheels = [
        *stops.compare_wheels(runs["step"], "step", pairs),
        *stops.compare_wheels(strong, "step", pairs, _STRONG),
    ]
    replays = stops.write_replays(runs, job.out / "replays", threads=sweeps.threads)
    job.write_rows(stops=endings, gear_against_round=wheels, replays=replays)
    return "\n\n\n".join(
        (
            stops.stops_text(endings),
            stops.wheels_text(wheels),
            stops.replays_text(replays, f"{job.out}/replays"),
        )
    )


def _run_stops(job: Job) -> None:
    sweeps = Sweeps(design=FULL if job.full else QUICK, **job.sampling)
    runs, head = cross_obstacles(sweeps)
    strong = sweeps.on_other_robots([_STRONG]).sel(robot=_STRONG)
    job.report("stops", _report_stops(job, sweeps, runs, strong), head)


SEIZURE = Study(
    text="Which track models get the Engineer over an edge, how often, and why not.",
    run=_run_seizure,
)
STOPS = Study(
    text="Why the runs of the seizure study stopped, and how gear wheels compare with round ones.",
    run=_run_stops,
)
