"""A finished run, with its branches, trials and comparison with another engine."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from textwrap import indent
from typing import TYPE_CHECKING, Any, Literal

from crawler2d import _core
from crawler2d.common.keywords import takes_keywords
from crawler2d.common.units import table_of_metrics
from crawler2d.errors import ScenarioError
from crawler2d.results.tip_over import TipOver, find_tip_over
from crawler2d.runs.branch import (
    EscapeForce,
    RecordMode,
    Trial,
    branch_scenario,
    branch_time,
    check_recording,
    read_push,
    refuse_unrepeatable,
    run_of_trial,
    simulate_branch,
    stop_time,
    trial_at,
    trial_names,
    trials_at,
    try_variant,
)
from crawler2d.runs.cross_check import CrossCheck, compare_engines
from crawler2d.runs.shown_run import ShownRun

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from crawler2d.parameters.scenario import Scenario
    from crawler2d.parameters.settings import Drive
    from crawler2d.parameters.track import Track
    from crawler2d.results.findings import TrialResult

__all__ = ["Run"]


class Run(ShownRun):
    """A finished run, as returned by `simulate`.

    Its arrays are read-only and share their first dimension, the n samples of `time`. With
    ``record="summary"`` there is no history; using it raises an AttributeError that says so.

    Attributes
    ----------
    scenario : Scenario
        The simulated scenario.
    outcome : Outcome or None
        How the run ended; None if there is no result, see `error`.
    diagnosis : Diagnosis or None
        Why the robot stopped, if it did; ``print(run.diagnosis)`` gives one sentence. `reason` says
        why a run that did not stop did not clear either.
    metrics : dict of str to float
        Figures of the whole run, listed below. Read-only; ``dict(run.metrics)`` is a mutable copy.
    edges : Table
        Corners of the ground: `id`, `lane`, `x`, `y` [m], `angle` [rad] (convex > 0), `radius` [m].
    events : Table
        Stops, and edges inside the track; see below.
    wall_time : float
        [s] Computing time on one thread.
    build : mapping of str to object
        The build that simulated it, see `build_info`; a loaded run may have another one.
    error : Crawler2dError or None
        Why there is no result, in a batch that was interrupted or used ``on_error="record"``.
    parent : tuple of Scenario and float, or None
        For a branch, or a run of a `Simulation`: the scenario it started from, and when [s].

    Notes
    -----
    The metrics:

    {metrics}

    On level ground the track distance exceeds the path length by the slip, and with gear wheels
    also because their effective rolling radius is smaller than the circumscribed one. On uneven
    ground the two differ even without slip: the track travels less where the nose comes down over a
    crest, and more in a hollow. A belt with grousers travels less than the robot over ridges: at
    its ends the tips are faster than the belt.

    The events, in order of their start. A "stop" is a period without progress despite a commanded
    speed; an "intrusion" is a period in which an edge was deeper than `criteria.intrusion_depth`
    inside the taut belt round the track's own bodies. A stop lists the most loaded intrusion
    present at its end. Ongoing events end with the run.

    ================  ====  =======================================================================
    column            unit  meaning
    ================  ====  =======================================================================
    `kind`                  "stop" or "intrusion"
    `start`, `end`    s     start and end
    `lane`                  0 under both tracks, 1 the left one, 2 the right one, 3 the belly
    `edge`                  id of the edge, -1 if none
    `bodies`                bodies on either side of the edge, in order of belt travel; () if none
    `depth`           m     largest depth inside the belt round the circumscribed circles
    `root_depth`      m     largest depth inside the belt round the root circles
    `force`           N     normal force on that piece of ground, mean over the event
    ================  ====  =======================================================================
    """

    @takes_keywords
    def branch(
        self,
        at: float | Literal["stop"] = "stop",
        *,
        track: Track | Literal["closed"] | None = None,
        friction: float | None = None,
        max_torque: float | None = None,
        belly: ArrayLike | Literal["built"] | None = "built",
        drive: Drive | None = None,
        push: tuple[float, float] | None = None,
        duration: float | None = None,
        record: RecordMode = "full",
        sample_interval: float = 0.01,
    ) -> Run:
        """Continue from an instant of this run with something changed.

        The run is repeated bit by bit up to that instant, and continues from the same pose and
        speeds. Another torque or friction, a push, or removing the belly leave the rest of the
        state unchanged. With another track or belly only pose and speeds carry over: ground inside
        the track dents it without pushing the robot, and the dent disappears as the robot moves on.
        The same holds for any branch of a run in rapier, which crawler2d's own dynamics continue at
        the run's time step.

        Parameters
        ----------
        at : float or "stop"
            [s] The instant; "stop" is that of the diagnosis. The branch starts at the end of the
            step that reaches it.
        track : track model or "closed", optional
            Another track model; "closed" is the `ClosedTrack` of its own.
        friction : float, optional
            [-] Another friction of the ground, in all lanes and segments.
        max_torque : float, optional
            [N m] Another torque of one sprocket, see `Drivetrain`.
        belly : array_like, optional
            [m] Another belly, see `Robot`; None removes it, "built" keeps it.
        drive : Drive, optional
            Another command. The times of its schedules count from the start of this run.
        push : tuple of two floats, optional
            [N], [s] A constant horizontal force at the chassis' centre of mass, above 0 towards +x,
            and the time over which it ramps up from 0.
        duration : float, optional
            [s] Duration of the branch; None takes the scenario's.
        record : {"full", "summary"}
            Whether to keep the history, or only outcome, metrics and events.
        sample_interval : float
            [s] Time between samples of the history, which fall on its multiples and on both ends.

        Returns
        -------
        Run
            The run from that instant on. Stops, metrics and outcome count from there, except `time`
            and `time_to_clear`, which count from the start of this run.

        Raises
        ------
        ScenarioError
            If `at` is not a time of the run, or is "stop" and the run did not end in one; if this
            run is a branch itself; if a change breaks a rule.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4))
        >>> run = c2d.simulate(robot, c2d.terrains.step(0.10))
        >>> str(run.outcome), str(run.branch(track=c2d.BeltTrack()).outcome)
        ('seized', 'cleared')
        """
        time = branch_time(self, at)
        variant = branch_scenario(
            self,
            track=track,
            friction=friction,
            max_torque=max_torque,
            belly=belly,
            drive=drive,
            duration=duration,
        )
        return self._branch_as(variant, time, push, record=record, sample_interval=sample_interval)

    def trials(self) -> tuple[Trial[Run], ...]:
        """Try everything that might free the robot from the stop at the end of the run.

        The results are added to the diagnosis, and so appear in plots and pages of the run.

        Returns
        -------
        tuple of Trial
            The results, by `Trial.name` and in this order, without trials that change nothing on
            the robot:

            - "unchanged": the run goes on; "rebuilt": its own track is built again. If either frees
              the robot, the stop was transient, and nothing else is concluded;
            - "closed track": the `ClosedTrack` of its own, in this pose; "closed track, clear of
              the ground": the same at rest, in the nearest pose with no ground inside it, as no
              belt can reach a pose with an edge between two wheels; "closed smooth track": in this
              pose, without grousers;
            - "belt": along the outlines of chassis and flippers, in this pose; "belt, from the
              start" and "closed track, from the start": the whole run again. These count as freed
              if they get past the stop;
            - "one motor": one per track instead of one per wheel;
            - "torque x 2", "torque x 10", "friction x 2", "no belly";
            - "flippers level": flippers turned to angle 0.

        Raises
        ------
        ScenarioError
            If the run did not end in a stop, or is a branch itself.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4))
        >>> run = c2d.simulate(robot, c2d.terrains.step(0.10))
        >>> [trial.name for trial in run.trials() if trial.freed]
        ['closed track', 'belt', 'friction x 2']
        """
        time = stop_time(self)
        results = trials_at(self, time, trial_names("all"))
        self._add_to_diagnosis(*results)
        return tuple(Trial.of(each, partial(self._run_of_trial, time, each)) for each in results)

    @takes_keywords
    def what_if(
        self,
        name: str | None = None,
        *,
        track: Track | Literal["closed"] | None = None,
        friction: float | None = None,
        max_torque: float | None = None,
        belly: ArrayLike | Literal["built"] | None = "built",
        drive: Drive | None = None,
        push: tuple[float, float] | None = None,
    ) -> Trial[Run]:
        """Try one change at the stop at the end of the run.

        Parameters
        ----------
        name : str, optional
            Name of one of the `trials`; without it, give changes as for `branch`.
        track, friction, max_torque, belly, drive, push
            See `branch`.

        Returns
        -------
        Trial
            Its result.

        Raises
        ------
        ScenarioError
            If the run did not end in a stop, or is a branch itself; if the named trial is unknown,
            changes nothing on the robot, or is given together with a change; if a change breaks a
            rule.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4))
        >>> run = c2d.simulate(robot, c2d.terrains.step(0.10))
        >>> run.what_if("torque x 2").freed, run.what_if(track=c2d.BeltTrack()).freed
        (False, True)
        """
        time = stop_time(self)
        changes: Any = {"track": track, "friction": friction, "max_torque": max_torque}
        changes |= {"belly": belly, "drive": drive}
        if name is not None:
            for field, value in {**changes, "push": push}.items():
                is_left_out = isinstance(value, str) if field == "belly" else value is None
                if not is_left_out:
                    raise ScenarioError(
                        field, value, "must not be given together with the name of a trial"
                    )
            result = trial_at(self, time, name)
            self._add_to_diagnosis(result)
            return Trial.of(result, partial(self._run_of_trial, time, result))
        variant = branch_scenario(self, **changes, duration=None)
        result, start = try_variant(self, time, variant, read_push(push))
        variant = variant.replace({"duration": result.duration})
        return Trial.of(result, partial(self._branch_as, variant, time, push, start=start))

    def _branch_as(
        self,
        variant: Scenario,
        time: float,
        push: tuple[float, float] | None,
        *,
        record: RecordMode = "full",
        sample_interval: float = 0.01,
        start: int | None = None,
    ) -> Run:
        how: Any = {"push": push, "record": record, "sample_interval": sample_interval}
        result = simulate_branch(self, time, variant, start=start, **how)
        return Run(variant, result, parent=(self.scenario, time))

    def _run_of_trial(self, time: float, trial: TrialResult) -> Run:
        variant, result = run_of_trial(self, time, trial.name)
        return Run(
            variant, result, parent=None if trial.is_from_the_start else (self.scenario, time)
        )

    def _add_to_diagnosis(self, *results: TrialResult) -> None:
        """Add trials of this run's stop to its diagnosis."""
        if self.diagnosis is not None:
            by_name = {result.name: result for result in (*self.diagnosis.trials, *results)}
            trials = tuple(by_name[name] for name in trial_names("all") if name in by_name)
            self.diagnosis = replace(self.diagnosis, trials=trials)

    def escape_force(self) -> EscapeForce:
        """Measure the push that frees the robot from the stop at the end of the run.

        A horizontal force at the chassis' centre of mass, in the commanded direction, starts at a
        hundredth of the weight and grows by a tenth every half second, until the robot is
        `criteria.escape_distance` beyond its greatest x before the stop.

        Returns
        -------
        EscapeForce
            [N] A tuple: the highest level that did not free it and the lowest that did. Its `tips`
            says whether that push tipped the robot over.

        Raises
        ------
        ScenarioError
            If the run did not end in a stop, or is a branch itself; without gravity.
        """
        time = stop_time(self)
        return EscapeForce(*_core.escape_force(self.scenario.to_json(), time))

    def tip_over(self) -> TipOver:
        """Explain how the robot tipped over, and try what would have kept it upright.

        The run is simulated again, and up to six times with one change: at half and at a tenth of
        the speed, and with the centre of mass moved away from the contact about which the robot
        turned, by 2, 5, 10 and 20 % of the axle distance, until it stays upright.

        Returns
        -------
        TipOver
            Direction of tipping, position of the centre of mass, and the results of the trials.

        Raises
        ------
        ScenarioError
            If the run did not tip over, is a branch, or is of another build.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> run = c2d.simulate(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.11))
        >>> fall = run.tip_over()
        >>> fall.backwards, fall.prevented_by
        (True, ('centre of mass 36 mm further forward',))
        """
        refuse_unrepeatable(self)
        tip_over = find_tip_over(self.scenario, try_changes=True)
        if tip_over is None:
            raise ScenarioError("run", self, f"must have tipped over, not {self.outcome}")
        return tip_over

    @takes_keywords
    def cross_check(
        self, *, announce: bool | Callable[[float, float], None] = True
    ) -> CrossCheck[Run]:
        """Simulate the same scenario in the other engine, and compare.

        A run of crawler2d's own dynamics is repeated in rapier, and vice versa, at that engine's
        default accuracy; nothing else differs. A run without history, or of another build, is
        simulated again. If both stop at different places, or only one stops, a static analysis
        finds which stop is an equilibrium. Runs with gear wheels or many small wheels are chaotic:
        for these compare rates, with a `sweep` or `compare` over ``solver.engine``.

        Parameters
        ----------
        announce : bool or callable
            rapier may take a thousand times as long. True prints the expected time to stderr if it
            may exceed 2 s; a callable gets two times [s]: if its run ends when this one did, and if
            it lasts for the whole `duration`.

        Returns
        -------
        CrossCheck
            Both runs, when their paths separate, how far apart they end, the forces and the
            `Balance` at the stops, and how often both engines agreed on such a model in a study.

        Raises
        ------
        ScenarioError
            If rapier does not support the scenario, see `Solver`; the path names the field. It does
            not support rotors: remove them with `Robot.without_rotors`. If the run has no result,
            or is a branch.
        SimulationDiverged
            If the state became non-finite in the other engine.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4))
        >>> run = c2d.simulate(robot.without_rotors(), c2d.terrains.step(0.1), duration=4.0)
        >>> check = run.cross_check()
        >>> check.same_outcome, all(balance.holds for balance in check.balances)
        (True, True)
        >>> bool(check.distance < 1e-3)
        True
        """
        return compare_engines(self, _with_history, announce=announce)


Run.__doc__ = (Run.__doc__ or "").replace("    {metrics}", indent(table_of_metrics(), "    "))


def _with_history(scenario: Scenario) -> Run:
    return Run(scenario, _core.simulate(scenario.to_json(), *check_recording(0.01, "full"), []))
