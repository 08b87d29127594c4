"""Results of a run as data: outcome, metrics, history, and the row in tables and stores."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Self, overload

import numpy as np

from crawler2d import _core
from crawler2d.common.arrays import Metrics, Table, freeze_array
from crawler2d.common.bodies import bodies_of, body_poses
from crawler2d.errors import Crawler2dError, ScenarioError, SimulationDiverged, own_error
from crawler2d.results.diagnosis import Diagnosis
from crawler2d.results.findings import Mechanism
from crawler2d.results.outcome import Outcome
from crawler2d.results.tip_over import find_tip_over

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.parameters.scenario import Scenario

__all__ = ["NO_RESULT", "Record", "Row", "diagnosis_json", "read_diagnosis"]


_BUILD: Mapping[str, Any] = MappingProxyType(_core.build_info())
"""The build that all runs of this process share."""


class _History:
    """An array of the history of a run; raises an AttributeError if there is none."""

    def __init__(self, doc: str) -> None:
        self.__doc__ = doc

    def __set_name__(self, _owner: type, name: str) -> None:
        self._name = name

    @overload
    def __get__(self, run: None, owner: type) -> Self: ...

    @overload
    def __get__(self, run: Record, owner: type) -> NDArray[np.float64]: ...

    def __get__(self, run: Record | None, owner: type) -> Self | NDArray[np.float64]:
        return self if run is None else run._history(self._name)

    def __set__(self, run: Record, value: object) -> None:
        raise AttributeError(f"{self._name} is read-only", name=self._name, obj=run)


class Record:
    """The data of a `Run`, documented there; pictures need nothing else.

    Parameters
    ----------
    scenario : Scenario
        The simulated scenario.
    result : mapping
        Results from the core.
    error : Crawler2dError, optional
        The reason if there is no result.
    parent : tuple of Scenario and float, optional
        For a branch, or a run of a `Simulation`: the scenario it started from, and when [s].
    """

    def __init__(
        self,
        scenario: Scenario,
        result: Mapping[str, Any],
        error: Crawler2dError | None = None,
        parent: tuple[Scenario, float] | None = None,
    ) -> None:
        self.scenario = scenario
        self.error = error
        self.parent = parent
        self.outcome = Outcome(result["outcome"]) if error is None else None
        self.diagnosis = _diagnosis_of(result.get("diagnosis"))
        self.metrics = Metrics(result.get("metrics", {}))
        self.edges = Table(result.get("edges", {}))
        self.events = Table(result.get("events", {}))
        self.wall_time: float = result.get("wall_time", 0.0)
        build = result.get("build", _BUILD)  # a loaded run may have another build
        self.build = _BUILD if build == _BUILD else MappingProxyType(dict(build))
        self._trace = {name: freeze_array(array) for name, array in result.get("trace", {}).items()}
        self._contacts = Table(result.get("contacts", {}))

    @property
    def reason(self) -> str:
        """Why the robot did not clear, in a sentence; empty if it did.

        For a stop it is the diagnosis; for a tip-over the run is simulated again, if by this build.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> robot = c2d.robots.engineer(flippers=None)
        >>> print(c2d.simulate(robot, c2d.terrains.step(0.05), duration=1.0).reason)
        timed out after 1.00 s, still driving at 99 % of the commanded speed
        """
        if self.error is not None:
            return str(self.error)
        if self.diagnosis is not None:  # further trials are added to it
            return str(self.diagnosis)
        return self._reason_without_stop

    @cached_property
    def _reason_without_stop(self) -> str:
        """Why a run with a result neither cleared nor stopped."""
        metrics, after, text = self.metrics, self._when, ""
        match self.outcome:
            case Outcome.TIPPED_OVER:
                is_repeatable = self.parent is None and self.build is _BUILD
                tip_over = is_repeatable and find_tip_over(self.scenario, try_changes=False)
                _, angle = self._tilt
                direction = "backwards" if angle > 0.0 else "forwards"
                text = str(tip_over or f"tipped over {direction} {after}")
            case Outcome.TIMED_OUT:
                text = f"timed out {after}, {self._driving}"
            case Outcome.LEFT_TERRAIN:
                place = "" if self.parent else f", at x = {metrics['final_x']:.3f} m"
                text = (
                    f"left the terrain {after}{place}: an end axle was beyond the described ground,"
                    " or a metre below it"
                )
            case Outcome.DETRACKED:
                text = (
                    f"threw its track {after}: a shoe came off its guide or wheels; pin forces"
                    f" reached {metrics['max_track_tension']:.0f} N"
                )
        return text

    @property
    def _driving(self) -> str:
        """How a robot drove that neither cleared nor stopped."""
        drive, time, progress = self.scenario.drive, self.metrics["time"], self.metrics["progress"]
        passed = [speed for start, speed in drive.schedule or () if start <= time]
        commanded = [drive.speed, *passed]
        if self._trace and len(self.time) > 1:  # a simulation had commands of its own
            commanded = self.commanded_speed.tolist()
        if commanded[-1] == 0.0:
            return "with a commanded speed of 0"
        if progress == 1.0:
            return "before a whole stop window was over"
        return f"still driving at {100 * progress:.0f} % of the commanded speed"

    @property
    def mechanism(self) -> Mechanism | None:
        """How ground inside the track is held, if the run stopped with such ground."""
        return None if self.diagnosis is None else self.diagnosis.mechanism

    @property
    def is_creeping(self) -> bool:
        """Whether the final progress was between `criteria.creep_from` and `criteria.creep_to`."""
        criteria = self.scenario.criteria
        progress = self.metrics.get("progress", 1.0)
        return criteria.creep_from <= progress < criteria.creep_to

    @property
    def has_history(self) -> bool:
        """Whether it was recorded in full."""
        return bool(self._trace)

    time = _History("[s] Time at the end of each sample interval, shape (n,).")
    position = _History("[m] x and y of the origin of the chassis frame, shape (n, 2).")
    velocity = _History("[m/s] Velocity of that point, shape (n, 2).")
    chassis_angle = _History("[rad] Nose up > 0, shape (n,).")
    angular_velocity = _History("[rad/s] Rate of change of the chassis angle, shape (n,).")
    commanded_speed = _History(
        "[m/s] Set point of the drivetrain, after its acceleration limits, shape (n,)."
    )
    track_speed = _History("[m/s] Surface speed of the track, mean over the drives, shape (n,).")
    track_position = _History("[m] Travel of the track surface, mean over the drives, shape (n,).")
    slip_ratio = _History("[-] 1 - v / track_speed, 0 where the track stands still, shape (n,).")
    tractive_effort = _History(
        "[N] Force of the ground along the driven surfaces, mean of the interval, shape (n,)."
    )
    drive_force = _History(
        "[N] Force of all motors at the track surface, mean of the interval, shape (n,)."
    )
    drive_speeds = _History(
        "[m/s] Surface speed of each of the k drives, motors before free wheels, shape (n, k)."
    )
    drive_positions = _History("[m] Travel of the surface of each of the k drives, shape (n, k).")
    drive_forces = _History(
        "[N] Motor force of each drive, 0 for free wheels, mean of the interval, shape (n, k)."
    )
    track_tension = _History(
        "[N] Largest force in any pin of a chain of shoes, 0 for other tracks, shape (n,)."
    )
    shoe_poses = _History(
        """[m, m, rad] Origin x, y and direction of travel of each of s shoes, shape (n, s, 3).

        The origin of a shoe lies halfway between its pins; s is 0 for other tracks.
        """
    )
    flipper_angles = _History(
        "[rad] Angle of the flippers at each of k ends, front first, upwards > 0, shape (n, k)."
    )
    flipper_torques = _History(
        "[N m] Torque of the flipper motors, both sides, upwards > 0, last step, shape (n, k)."
    )

    @property
    def bodies(self) -> Table:
        """Bodies of the robot, one row each, in the order of `poses`; computed on access.

        Bodies that can touch the ground come first: row k is `body` k of the contacts. Then come
        the wheels inside belts and guides, which touch nothing.

        =========  ====  ==========================================================================
        column     unit  meaning
        =========  ====  ==========================================================================
        `body`           as in the contacts; -1: touches nothing
        `kind`           code of a `BodyKind`
        `lane`           code of the `Lane` of its track
        `carrier`        "chassis", "front flipper" or "rear flipper"
        `shoe`           number of the shoe that it belongs to, as in `shoe_poses`; -1: none
        `radius`   m     radius of a circle; NaN for other shapes
        `outline`  m     corners in its own frame, counter-clockwise, shape (m, 2)
        =========  ====  ==========================================================================
        """
        return bodies_of(self.scenario.to_json())

    @property
    def poses(self) -> NDArray[np.float64]:
        """[m, m, rad] Origin x, y and angle of the frame of each of k bodies, shape (n, k, 3).

        Computed from the history on every access, so keep the result. Angles count full turns, so
        poses may be interpolated between samples. Belts, skids, the guide and the belly have the
        frame of the part that carries them; a belt's surface moves within its outline. The idler of
        a chain is shown without the motion of its tensioner.

        Examples
        --------
        Final position of the outline of the second wheel from the rear:

        >>> import numpy as np
        >>> import crawler2d as c2d
        >>> robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4))
        >>> run = c2d.simulate(robot, c2d.terrains.flat(), duration=1.0)
        >>> x, y, angle = run.poses[-1, 1]
        >>> turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        >>> corners = run.bodies["outline"][1] @ turn.T + (x, y)
        >>> bool(abs(corners[:, 1].min()) < 1e-4)  # it stands on the ground
        True
        """
        self._history("time")
        return freeze_array(body_poses(self.scenario.to_json(), self._trace)["bodies"])

    @property
    def contacts(self) -> Table:
        """Contacts with the ground, one row per contact and sample; forces are interval means."""
        self._history("time")
        return self._contacts

    def _history(self, name: str) -> NDArray[Any]:
        if self._trace:
            return self._trace[name]
        if self.error is not None:
            raise AttributeError(f"this run has no history: {self.error}", name=name, obj=self)
        message = "this run has no history: it was recorded with record='summary'"
        raise AttributeError(message, name=name, obj=self)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the data; arrays stay read-only in the copy."""
        result = {
            "outcome": self.outcome,
            "diagnosis": None if self.diagnosis is None else self.diagnosis.to_dict(),
            "metrics": self.metrics,
            "edges": dict(self.edges),
            "events": dict(self.events),
            "wall_time": self.wall_time,
            "build": dict(self.build),
            "trace": self._trace,
            "contacts": dict(self._contacts),
        }
        return type(self), (self.scenario, result, self.error, self.parent)

    def __repr__(self) -> str:
        """Show what ran and how it ended."""
        return f"{type(self).__name__}({self.title})"

    @property
    def title(self) -> str:
        """What ran and how it ended, in one line for tables and plots."""
        return f"{self.subject}: {self.ending}"

    @property
    def ending(self) -> str:
        """How and when the run ended, in a few words.

        A run continues for a while after it reaches the goal or a stop begins: the time given is
        that of the goal or of the beginning of the stop.
        """
        if self.error is not None:
            return type(self.error).__name__
        if self.diagnosis is not None and self.diagnosis.outcome.is_stop:
            return f"{self.outcome} at {self.diagnosis.since:.2f} s"
        return f"{self.outcome} {self._when}"

    @property
    def _when(self) -> str:
        """When a run without a stop had its outcome; a simulation may have gone on after that."""
        time, word = self.metrics["time"], "after"
        match self.outcome:
            case Outcome.CLEARED:
                time = self.metrics["time_to_clear"]
            case Outcome.TIPPED_OVER:
                time, _ = self._tilt
            case Outcome.LEFT_TERRAIN | Outcome.DETRACKED if self.parent:
                word = "within"
        return f"{word} {time:.2f} s"

    @property
    def _tilt(self) -> tuple[float, float]:
        """[s], [rad] When the robot had tipped over, and the angle of the chassis."""
        if self._trace:
            over = np.abs(self.chassis_angle) > self.scenario.criteria.tip_over_angle
            if over.any():
                first = over.argmax()
                return float(self.time[first]), float(self.chassis_angle[first])
        return self.metrics["time"], self.metrics["final_angle"]

    @property
    def provenance(self) -> str:
        """Version of crawler2d and identity of the scenario, to mark files.

        It is the comment of films and the last line of pages. Identities include seeds.

        Raises
        ------
        ScenarioError
            If the scenario breaks a rule.

        Examples
        --------
        >>> import io
        >>> import crawler2d as c2d
        >>> robot = c2d.robots.engineer(flippers=None)
        >>> run = c2d.simulate(robot, c2d.terrains.step(0.05), duration=1.0)
        >>> about = {"Description": run.provenance}
        >>> run.plot().figure.savefig(io.BytesIO(), format="svg", metadata=about)
        >>> run.scenario.identity in run.provenance
        True
        """
        made = f"crawler2d {self.build['version']}, scenario {self.scenario.identity}"
        if self.parent is None:
            return made
        scenario, time = self.parent
        return f"{made}, branched off scenario {scenario.identity} at {time!r} s"

    @property
    def subject(self) -> str:
        """Robot and ground, in one line."""
        robot, terrain = self.scenario.robot, self.scenario.terrain
        kinds = (_kind(getattr(robot, "track", None)), _kind(terrain))
        return ", ".join(map(str, (getattr(robot, "name", robot), *kinds)))


def _kind(part: object) -> str:
    # An invalid scenario may hold anything.
    return str(getattr(part, "kind", type(part).__name__)).replace("_", " ")


NO_RESULT = ("diverged", "refused", "failed")
"""Outcomes of runs without a result: non-finite state, broken rule, other error."""


@dataclass(frozen=True, slots=True)
class Row:
    """One run.

    Attributes
    ----------
    identity : str
        Identity of the scenario; "" if it breaks a rule.
    scenario : str
        The scenario as JSON; "" if it breaks a rule.
    outcome : str
        How it ended, or one of `NO_RESULT`.
    metrics : mapping of str to float
        As in `Run.metrics`; empty without a result.
    diagnosis : mapping, optional
        Diagnosis of a stop, as read by `Diagnosis.from_core`.
    wall_time : float
        [s] Computing time on one thread; nan without a result.
    error : Crawler2dError, optional
        Why there is no result.
    """

    identity: str
    scenario: str
    outcome: str
    metrics: Mapping[str, float]
    diagnosis: Mapping[str, Any] | None = None
    wall_time: float = float("nan")
    error: Crawler2dError | None = None

    @classmethod
    def of_result(cls, identity: str, scenario: str, result: Mapping[str, Any]) -> Row:
        """Make a row from the core's result for a scenario."""
        error = result.get("error")
        if error is not None:
            return cls.of_error(own_error(error), identity, scenario)
        return cls(
            identity,
            scenario,
            str(result["outcome"]),
            Metrics(result["metrics"]),
            result["diagnosis"],
            result["wall_time"],
        )

    @classmethod
    def of_error(cls, error: Crawler2dError, identity: str = "", scenario: str = "") -> Row:
        """Make a row for a run without a result."""
        diverged, refused, failed = NO_RESULT
        match error:
            case SimulationDiverged():
                outcome = diverged
            case ScenarioError():
                outcome = refused
            case _:  # out of memory, or a bug
                outcome = failed
        return cls(identity, scenario, outcome, {}, error=error)

    @classmethod
    def of_record(cls, run: Record) -> Row:
        """Make a row from a run."""
        try:
            text, identity = run.scenario.to_json(), run.scenario.identity
        except ScenarioError:
            text = identity = ""
        if run.error is not None:
            return cls.of_error(run.error, identity, text)
        values = None if run.diagnosis is None else run.diagnosis.to_dict()
        return cls(identity, text, str(run.outcome), run.metrics, values, run.wall_time)

    def read_diagnosis(self) -> Diagnosis | None:
        """Convert `diagnosis` to an object."""
        return _diagnosis_of(self.diagnosis)


def _diagnosis_of(values: Mapping[str, Any] | None) -> Diagnosis | None:
    return None if values is None else Diagnosis.from_core(values)


def diagnosis_json(diagnosis: Mapping[str, Any]) -> str:
    """Write a diagnosis as JSON with exact numbers."""
    return json.dumps(diagnosis, default=np.ndarray.tolist, separators=(",", ":"))


def read_diagnosis(text: str) -> dict[str, Any]:
    """Read what `diagnosis_json` wrote."""
    values: dict[str, Any] = json.loads(text)
    values["contacts"] = {name: np.array(column) for name, column in values["contacts"].items()}
    values["position"] = tuple(values["position"])
    for trial in values["trials"]:
        trial.update({name: tuple(trial[name]) for name in ("position", "flipper_angles")})
    for each in (values, *values["trials"]):
        if inside := each.get("intrusion"):
            inside.update({name: tuple(inside[name]) for name in ("edges", "bodies", "body_kinds")})
    if values["mechanism"] == "bellied":
        # Earlier builds used this name for ground that only the belly rests on.
        values["mechanism"] = None
    return values
