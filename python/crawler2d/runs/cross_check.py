"""Compare a run with the same scenario in the other engine."""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Generic, Literal, TypeVar

import numpy as np

from crawler2d import _core
from crawler2d.common.arrays import Table
from crawler2d.errors import ScenarioError
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.track import (
    ForceTrack,
    GearWheel,
    HybridWheels,
    LineOfWheels,
    WheeledTrack,
)
from crawler2d.results.diagnosis import body_name
from crawler2d.results.findings import Balance
from crawler2d.results.record import Record
from crawler2d.runs.branch import refuse_without_result

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from matplotlib.axes import Axes

    from crawler2d.parameters.scenario import Scenario

__all__ = ["STUDY", "Agreement", "CrossCheck", "agreement_of", "compare_engines"]

STUDY = {
    "force on skids": (128, 128, 32, 32),
    "force on wheels": (128, 128, 32, 32),
    "line of 3": (128, 128, 80, 80),
    "line of 4, touching": (128, 128, 40, 40),
    "line of 5": (128, 128, 120, 120),
    "line of 9": (128, 128, 104, 104),
    "line of 3 gears": (128, 126, 62, 62),
    "line of 5 gears": (128, 126, 98, 100),
    "24 all round": (128, 102, 60, 60),
    "24 gears all round": (128, 93, 49, 70),
    "16 all round, spaced": (128, 128, 16, 16),
    "hybrid": (128, 126, 18, 16),
    "hybrid gears": (128, 117, 69, 78),
}
"""Runs; both or neither got over; got over in crawler2d; got over in rapier.

From docs/studies/agreement.md, "The cells of the seizure study"; a test compares both.
"""

_DIRECTIONS = {
    "24 all round": (
        "at steps and a barrier Chipmunk gets over as crawler2d does and rapier stops,"
        " on knife edges Chipmunk and rapier get over where crawler2d stops"
    ),
    "24 gears all round": "at steps Chipmunk gets over as seldom as crawler2d, rapier more often",
}
"""How the two differ where a third engine was run; same page, "As ensembles"."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Agreement:
    """How often both engines agreed on models of one kind; ``str(...)`` summarises it.

    Attributes
    ----------
    models : tuple of str
        The study's models of this kind; empty if it has none.
    runs, agreeing : int
        Number of runs, and of runs in which both or neither got over.
    own, rapier : int
        Number of runs that got over in crawler2d's own dynamics and in rapier.
    """

    models: tuple[str, ...]
    runs: int
    agreeing: int
    own: int
    rapier: int

    def __str__(self) -> str:
        """Summarise how often they agreed and how they differ."""
        if not self.models:
            return "How often both engines agree on such a model was not studied"
        text = (
            f"In the seizure study, with tracks of this kind ({'; '.join(self.models)}), both got"
            f" over or neither did in {self.agreeing} of {self.runs} runs; {self.own} got over in"
            f" crawler2d's own dynamics, {self.rapier} in rapier"
        )
        directions = [_DIRECTIONS[model] for model in self.models if model in _DIRECTIONS]
        return "; ".join([text, *directions])


def agreement_of(robot: Robot) -> Agreement:
    """Look up how often both engines agreed on models like a robot's.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> found = agreement_of(c2d.robots.engineer(track=c2d.CircumferentialWheels(24)))
    >>> found.models, found.agreeing, found.runs
    (('24 all round',), 102, 128)
    """
    models = _models_like(robot)
    runs, agreeing, own, rapier = (sum(STUDY[model][k] for model in models) for k in range(4))
    return Agreement(models=models, runs=runs, agreeing=agreeing, own=own, rapier=rapier)


def _models_like(robot: Robot) -> tuple[str, ...]:
    """Name the study's models of the same kind as a robot's, whatever their numbers."""
    track = robot.track
    if isinstance(track, ForceTrack):
        return ("force on skids", "force on wheels")
    if not isinstance(track, WheeledTrack):
        return ()
    is_geared = isinstance(track.wheel, GearWheel)
    if isinstance(track, LineOfWheels):
        round_ones = ("line of 3", "line of 4, touching", "line of 5", "line of 9")
        return ("line of 3 gears", "line of 5 gears") if is_geared else round_ones
    if isinstance(track, HybridWheels):
        return ("hybrid gears",) if is_geared else ("hybrid",)
    if track.wheel_radius is not None:
        return () if is_geared else ("16 all round, spaced",)
    return ("24 gears all round",) if is_geared else ("24 all round",)


_PARTED = 1e-3
"""[m] Distance at which two paths count as separate."""

_SAMPLE = 0.1
"""[s] Simulated time that is run first to measure its computing time."""
_LONG = 2.0
"""[s] Longer computing times are announced."""

_NAMES = {"own": "crawler2d's own dynamics", "rapier": "rapier"}

R = TypeVar("R", bound=Record)


@dataclass(frozen=True, kw_only=True, eq=False)
class CrossCheck(Generic[R]):
    """A run, the same scenario in the other engine, and where they differ; see `Run.cross_check`.

    ``str(check)`` summarises it in a few sentences. Poses are those at the end of the runs: for a
    stop, the mean pose of its diagnosis.

    Attributes
    ----------
    run, other : Run
        The run and the one in the other engine, both with history.
    same_outcome : bool
        Whether both had the same outcome. "seized" depends on trials, for which both use
        crawler2d's own dynamics; see docs/decisions/0016.
    distance : float
        [m] Distance between the final poses of `run` and `other`.
    turn : float
        [rad] Final chassis angle of `other` minus that of `run`.
    parted_at : float or None
        [s] First sample of `run` at which the origins of the chassis frames were more than 1 mm
        apart; None if one of the runs ended before.
    balances : tuple of Balance or None
        Whether the stops of `run` and `other` are equilibria of rigid bodies with Coulomb friction;
        None for a run that did not end in a stop.
    forces : Table
        Forces of the ground on each load-bearing body in a stop, see below.
    agreement : Agreement
        How often both engines agreed on such a model in a study, and how they differ.

    Notes
    -----
    The forces have one row for each body that bears load in either stop; columns of a run that did
    not end in a stop are NaN.

    ==============================  ====  =====================================================
    column                          unit  meaning
    ==============================  ====  =====================================================
    `lane`, `body`, `body_kind`           as in the contacts
    `force_x`, `force_y`            N     sum over the contacts of the body in the stop of `run`
    `other_force_x`,                N     the same of `other`
    `other_force_y`
    ==============================  ====  =====================================================
    """

    run: R
    other: R
    distance: float
    turn: float
    parted_at: float | None
    balances: tuple[Balance | None, Balance | None]
    forces: Table
    agreement: Agreement

    @property
    def same_outcome(self) -> bool:
        """Whether both had the same outcome."""
        return self.run.outcome == self.other.outcome

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw both robots where they ended, both paths, and where the paths separate.

        Parameters
        ----------
        ax : Axes, optional
            Where to draw; None makes a figure.

        Returns
        -------
        Axes
            With x and y in metres, at equal scale.

        Raises
        ------
        ImportError
            If matplotlib is missing; the message names the extra to install.
        """
        from crawler2d.pictures.side_view import plot_both  # noqa: PLC0415 - optional

        names = (_engine(self.run), _engine(self.other))
        return plot_both((self.run, self.other), names, self.parted_at, ax, str(self))

    def __str__(self) -> str:
        """Describe the differences, and whether each stop is a static equilibrium."""
        return ". ".join(_sentences(self)) + "."


def _engine(run: Record) -> str:
    """Name the engine of a run."""
    return _NAMES[run.scenario.solver.engine]


def compare_engines(
    run: R, simulate: Callable[[Scenario], R], *, announce: bool | Callable[[float, float], None]
) -> CrossCheck[R]:
    """Simulate a run's scenario in the other engine, with its history, and compare.

    `announce` is given the expected time [s]: see `Run.cross_check`.
    """
    refuse_without_result(run)
    if not (callable(announce) or isinstance(announce, bool)):
        raise ScenarioError("announce", announce, "must be True, False or a callable")
    scenario = _in_the_other_engine(run.scenario)
    if announce:
        engine = _NAMES[scenario.solver.engine]
        show = announce if callable(announce) else partial(_announce, engine)
        show(*_expected_time(run, scenario))
    other = simulate(scenario)
    # Check statics on the run as repeated by this build.
    is_repeatable = run.build["build_id"] == _core.build_info()["build_id"]
    first = run if run.has_history and is_repeatable else simulate(run.scenario)
    (x, y, angle), (other_x, other_y, other_angle) = _last_pose(first), _last_pose(other)
    return CrossCheck(
        run=first,
        other=other,
        distance=float(np.hypot(other_x - x, other_y - y)),
        turn=other_angle - angle,
        parted_at=_parted_at(first, other),
        balances=(_balance(first), _balance(other)),
        forces=_forces(first, other),
        agreement=agreement_of(run.scenario.robot),
    )


def _expected_time(run: Record, scenario: Scenario) -> tuple[float, float]:
    """[s] Expected computing time if the scenario ends when a run did, and at most.

    Timed on its first steps: costs of models differ by a factor of a hundred.
    """
    simulation = _core.Simulation(scenario.to_json())
    begin = time.perf_counter()
    simulation.advance(_SAMPLE)
    pace = (time.perf_counter() - begin) / _SAMPLE
    return pace * run.metrics["time"], pace * max(scenario.duration, run.metrics["time"])


def _announce(engine: str, likely: float, most: float) -> None:
    """Print the expected time to stderr if it may be long."""
    if most >= _LONG:
        sys.stderr.write(
            f"cross_check: {engine} will take about {likely:.2g} s if its run ends when this one"
            f" did, up to about {most:.2g} s if it lasts\n"
        )
        sys.stderr.flush()


def _in_the_other_engine(scenario: Scenario) -> Scenario:
    """Give the scenario to the other engine, at its own default accuracy."""
    engine: Literal["own", "rapier"] = "rapier" if scenario.solver.engine == "own" else "own"
    solver = replace(scenario.solver, engine=engine, accuracy=None, time_step=None)
    return scenario.replace({"solver": solver})


def _balance(run: Record) -> Balance | None:
    """Compute whether forces could balance the stop that a run ended in."""
    if run.diagnosis is None:
        return None
    result = _core.balance(run.scenario.to_json(), run.diagnosis.time)
    return None if result is None else Balance.from_core(result)


def _last_pose(run: Record) -> tuple[float, float, float]:
    """[m, m, rad] Pose of the stop, or else at the end."""
    if run.diagnosis is not None:
        (x, y), angle = run.diagnosis.position, run.diagnosis.chassis_angle
    else:
        (x, y), angle = run.position[-1].tolist(), float(run.chassis_angle[-1])
    return x, y, angle


def _parted_at(run: Record, other: Record) -> float | None:
    """[s] Time at which the paths are first more than `_PARTED` apart."""
    both = run.time <= other.time[-1]
    there = np.stack([np.interp(run.time[both], other.time, each) for each in other.position.T])
    apart = np.hypot(*(run.position[both].T - there)) > _PARTED
    return float(run.time[both][apart.argmax()]) if apart.any() else None


def _forces(run: Record, other: Record) -> Table:
    """[N] The load on each body in each stop."""
    stops = [_loads(run), _loads(other)]
    rows = sorted({row for stop in stops if stop is not None for row in stop})
    columns = {
        name: np.array([row[place] for row in rows], dtype=np.int64)
        for place, name in enumerate(("lane", "body", "body_kind"))
    }
    for prefix, stop in zip(("", "other_"), stops, strict=True):
        missing = (np.nan, np.nan) if stop is None else (0.0, 0.0)
        forces = np.array([(stop or {}).get(row, missing) for row in rows]).reshape(-1, 2)
        columns |= {f"{prefix}force_x": forces[:, 0], f"{prefix}force_y": forces[:, 1]}
    return Table(columns)


def _loads(run: Record) -> dict[tuple[int, int, int], tuple[float, float]] | None:
    """[N] Forces of the ground in a stop, by lane, body and its kind."""
    if run.diagnosis is None:
        return None
    contacts = run.diagnosis.contacts
    normal = np.stack([contacts["normal_x"], contacts["normal_y"]])
    tangent = np.stack([normal[1], -normal[0]])
    force = contacts["normal_force"] * normal + contacts["friction_force"] * tangent
    sums: dict[tuple[int, int, int], tuple[float, float]] = {}
    keys = zip(*(contacts[name].tolist() for name in ("lane", "body", "body_kind")), strict=True)
    for key, (x, y) in zip(keys, force.T.tolist(), strict=True):
        before = sums.get(key, (0.0, 0.0))
        sums[key] = (before[0] + x, before[1] + y)
    return sums


def _sentences(check: CrossCheck[R]) -> Iterator[str]:
    """Describe how each run ended, when the paths separated, and which stop is an equilibrium."""
    runs = (check.run, check.other)
    ends = [f"{_engine(run)}: {_ended(run)}" for run in runs]
    if all(run.diagnosis is not None for run in runs):
        ends[1] += (
            f", {1e3 * check.distance:.2g} mm and {1e3 * abs(check.turn):.2g} mrad from there"
        )
    yield "; ".join(ends)
    if check.parted_at is None:
        yield f"The paths stay within {1e3 * _PARTED:g} mm of each other"
    else:
        yield f"The paths first part by {1e3 * _PARTED:g} mm at {check.parted_at:.2f} s"
    stops = {
        _engine(run): balance.describe(
            [body_name(run.diagnosis, pull.body) for pull in balance.pulls]
        )
        for run, balance in zip(runs, check.balances, strict=True)
        if balance is not None and run.diagnosis is not None
    }
    if len(stops) > len(set(stops.values())):
        yield f"By statics each stop is {next(iter(stops.values()))}"
    else:
        yield from (f"By statics the stop in {name} is {text}" for name, text in stops.items())
    yield str(check.agreement)


def _ended(run: Record) -> str:
    if run.diagnosis is None:
        return run.ending.replace("_", " ")
    outcome = str(run.outcome).replace("_", " ")
    x, y, angle = _last_pose(run)
    return f"{outcome} at x = {x:z.3f} m, y = {y:z.3f} m, {np.degrees(angle):z.1f} degrees nose up"
