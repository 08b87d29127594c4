"""What came out of a run: outcome, figures, history."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal, overload

from crawler2d import branch as branching
from crawler2d._frozen import Figures, read_only
from crawler2d._recording import Recording
from crawler2d.bodies import bodies_of, moved
from crawler2d.diagnosis import Counterfactual, Diagnosis, Mechanism
from crawler2d.errors import Crawler2dError
from crawler2d.outcome import Outcome
from crawler2d.table import Table

if TYPE_CHECKING:
    from os import PathLike
    from pathlib import Path

    import numpy as np
    import xarray
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray

    from crawler2d.scenario import Drive, Scenario
    from crawler2d.track import Track

__all__ = ["Run"]


class Run:
    """One finished run; `simulate` makes them.

    Its arrays are read-only and share their first dimension, the n samples of `time`. With
    ``record="summary"`` there is no history, and asking for it is an AttributeError that says so.

    Attributes
    ----------
    scenario : Scenario
        What was simulated.
    outcome : Outcome or None
        How it ended; None where `error` says why there is no result.
    diagnosis : Diagnosis or None
        Why it stopped, if it ended in a stop; ``print(run.diagnosis)`` says it in a sentence.
    metrics : dict of str to float
        Figures of the whole run, see the notes; ``dict(run.metrics)`` is a copy that can be
        changed.
    edges : Table
        Corners of the ground: `id`, `lane`, `x`, `y` [m], `angle` [rad] (convex > 0), `radius` [m].
    events : Table
        Stops, and edges inside the track, see the notes.
    wall_time : float
        [s] Computing time of one thread.
    error : Crawler2dError or None
        Why there is no result, in a batch with ``on_error="record"`` or one that was interrupted.
    trunk : tuple of Scenario and float, or None
        For a branch: what was simulated before it, and until when [s].

    Notes
    -----
    The metrics:

    =======================  =====  ===============================================================
    name                     unit   meaning
    =======================  =====  ===============================================================
    `time`                   s      simulated time
    `time_to_clear`          s      when the goal was reached and from then on held; inf if not
    `final_x`, `final_y`     m      last position of the chassis frame
    `final_angle`            rad    last chassis angle
    `distance`               m      final x less that of the start
    `track_distance`         m      how far the track surface has run: of wheels what odometry with
                                    the circumscribed radius reads, of belts the way of the belt
    `path_length`            m      how far the chassis frame has truly gone, along its own axis
    `max_angle`,             rad    of the chassis
    `min_angle`
    `max_penetration`        m      deepest overlap of any part with the ground
    `drive_work`             J      work of the motors
    `stopped_time`           s      spent in stops
    `time_to_free`           s      longest stop from which the robot freed itself, 0 if none
    `progress`               -      share of the commanded distance made in the last stop window
    `vertical_acceleration`  m/s^2  of the chassis frame, averaged over 10 ms; root mean square
    `angular_velocity`       rad/s  rate of the chassis angle, root mean square
    `intrusion_depth`        m      greatest depth of the most loaded of the intrusions that last to
                                    the end, below the circumscribed circles; 0 if there is none
    `intrusion_root_depth`   m      the same below the root circles
    `intrusion_force`        N      its mean normal force
    `max_track_tension`      N      largest force in a pin of a chain of shoes; 0 without one
    `max_pin_gap`            m      farthest that a pin was off
    `max_guide_penetration`  m      deepest overlap of a shoe with guide, wheels or teeth
    `max_sprocket_slip`      m      farthest that a chain ran ahead of its sprocket or behind; some
                                    hundredths of a pitch are the play of the teeth
    =======================  =====  ===============================================================

    On level ground the track distance exceeds the path length by the slip; on gear wheels also
    because these roll on less than their circumscribed circle. On uneven ground the two differ
    without slip, too: the track runs less where the nose comes down over a crest, and more in a
    hollow. A belt with grousers reads less than its way over ridges: where it stands on its ends,
    the tips are faster than the belt.

    The events, in order of their start. One of the kind "stop" is a span without progress although
    commanded; one of the kind "intrusion" is a span in which an edge was deeper than
    `criteria.intrusion_depth` within the taut belt round the track's own bodies. A stop carries the
    most loaded of the intrusions present at its end. What lasts ends with the run.

    ================  ====  =======================================================================
    column            unit  meaning
    ================  ====  =======================================================================
    `kind`                  "stop" or "intrusion"
    `start`, `end`    s     when
    `lane`                  0 under both tracks, 1 the left one, 2 the right one, 3 the belly
    `edge`                  id of the edge, -1 if none
    `bodies`                bodies on either side of it, in order of belt travel; () if none
    `depth`           m     deepest reach below the belt round the circumscribed circles
    `root_depth`      m     deepest reach below the belt round the root circles
    `force`           N     normal force on that piece of ground, mean over the event
    ================  ====  =======================================================================
    """

    def __init__(
        self,
        scenario: Scenario,
        result: Mapping[str, Any],
        error: Crawler2dError | None = None,
        trunk: tuple[Scenario, float] | None = None,
    ) -> None:
        self.scenario = scenario
        self.error = error
        self.trunk = trunk
        self.outcome = Outcome(result["outcome"]) if error is None else None
        why = result.get("diagnosis")
        self.diagnosis = None if why is None else Diagnosis.from_core(why)
        self.metrics = Figures(result.get("metrics", {}))
        self.edges = Table(result.get("edges", {}))
        self.events = Table(result.get("events", {}))
        self.wall_time: float = result.get("wall_time", 0.0)
        self._trace = {name: read_only(array) for name, array in result.get("trace", {}).items()}
        self._contacts = Table(result.get("contacts", {}))

    @property
    def mechanism(self) -> Mechanism | None:
        """How ground inside the track is held, if the run ended in a stop and there is any."""
        return None if self.diagnosis is None else self.diagnosis.mechanism

    @property
    def is_creeping(self) -> bool:
        """Whether it made a little way at its end, between `criteria.creep_from` and `creep_to`."""
        criteria = self.scenario.criteria
        progress = self.metrics.get("progress", 1.0)
        return criteria.creep_from <= progress < criteria.creep_to

    @property
    def time(self) -> NDArray[np.float64]:
        """[s] End of each sample interval, shape (n,)."""
        return self._recorded("time")

    @property
    def position(self) -> NDArray[np.float64]:
        """[m] Origin of the chassis frame, x and y, shape (n, 2)."""
        return self._recorded("position")

    @property
    def velocity(self) -> NDArray[np.float64]:
        """[m/s] Velocity of that point, shape (n, 2)."""
        return self._recorded("velocity")

    @property
    def chassis_angle(self) -> NDArray[np.float64]:
        """[rad] Nose up > 0, shape (n,)."""
        return self._recorded("chassis_angle")

    @property
    def angular_velocity(self) -> NDArray[np.float64]:
        """[rad/s] Rate of the chassis angle, shape (n,)."""
        return self._recorded("angular_velocity")

    @property
    def commanded_speed(self) -> NDArray[np.float64]:
        """[m/s] Set-point of the drivetrain, within its acceleration limits, shape (n,)."""
        return self._recorded("commanded_speed")

    @property
    def track_speed(self) -> NDArray[np.float64]:
        """[m/s] Surface speed of the track, the mean of the drives, shape (n,)."""
        return self._recorded("track_speed")

    @property
    def track_position(self) -> NDArray[np.float64]:
        """[m] How far the surface has run, the mean of the drives, shape (n,)."""
        return self._recorded("track_position")

    @property
    def slip_ratio(self) -> NDArray[np.float64]:
        """[-] 1 - v / track_speed, 0 where the track stands, shape (n,)."""
        return self._recorded("slip_ratio")

    @property
    def tractive_effort(self) -> NDArray[np.float64]:
        """[N] Force of the ground along the driven surfaces, mean over the interval, shape (n,)."""
        return self._recorded("tractive_effort")

    @property
    def drive_force(self) -> NDArray[np.float64]:
        """[N] Force of all motors at the surface, mean over the interval, shape (n,)."""
        return self._recorded("drive_force")

    @property
    def drive_speeds(self) -> NDArray[np.float64]:
        """[m/s] Surface speed of each of the k drives, motors before free wheels, shape (n, k)."""
        return self._recorded("drive_speeds")

    @property
    def drive_positions(self) -> NDArray[np.float64]:
        """[m] How far the surface of each of the k drives has run, shape (n, k)."""
        return self._recorded("drive_positions")

    @property
    def drive_forces(self) -> NDArray[np.float64]:
        """[N] Force of the motor of each drive, 0 for free wheels, interval means, shape (n, k)."""
        return self._recorded("drive_forces")

    @property
    def track_tension(self) -> NDArray[np.float64]:
        """[N] Largest force in a pin of a chain of shoes, 0 for other tracks, shape (n,)."""
        return self._recorded("track_tension")

    @property
    def shoe_poses(self) -> NDArray[np.float64]:
        """[m, m, rad] Middle x, y and direction of travel of each of s shoes, shape (n, s, 3).

        The origin of a shoe lies halfway between its pins; s is 0 for other tracks.
        """
        return self._recorded("shoe_poses")

    @property
    def flipper_angles(self) -> NDArray[np.float64]:
        """[rad] Of the flippers at each of k ends, the front first, upwards > 0, shape (n, k)."""
        return self._recorded("flipper_angles")

    @property
    def flipper_torques(self) -> NDArray[np.float64]:
        """[N m] Of their motors, both sides together, upwards > 0, of the last step; (n, k)."""
        return self._recorded("flipper_torques")

    @property
    def bodies(self) -> Table:
        """Bodies of the robot, one row each, in the order of `poses`; computed when asked for.

        First come those that can meet the ground: row k is the `body` k of the contacts. After them
        come the wheels within belts and guides, which meet nothing.

        =========  ====  ==========================================================================
        column     unit  meaning
        =========  ====  ==========================================================================
        `body`           as in the contacts; -1: it meets nothing
        `kind`           code of a `BodyKind`
        `lane`           code of the `Lane` of its track
        `carrier`        "chassis", "front flipper" or "rear flipper"
        `shoe`           number of the shoe that it belongs to, as in `shoe_poses`; -1: none
        `radius`   m     of a circle; nan where it is none
        `outline`  m     corners in its own frame, counter-clockwise, shape (m, 2)
        =========  ====  ==========================================================================
        """
        return bodies_of(self.scenario)

    @property
    def poses(self) -> NDArray[np.float64]:
        """[m, m, rad] Origin x, y and angle of the frame of each of k bodies, shape (n, k, 3).

        They are computed from the history when asked for: keep them while you need them. Angles
        count full turns, so poses may be interpolated between samples. Belts, skids, the guide and
        the belly have the frame of what carries them; a belt's surface moves within its outline.
        The idler of a chain is where it is built.

        Examples
        --------
        Where the outline of the second wheel from the rear is in the end:

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
        self._recorded("time")
        return read_only(moved(self.scenario, self._trace)["bodies"])

    @property
    def contacts(self) -> Table:
        """Contacts of robot and ground, one row a contact and sample; forces are interval means."""
        self._recorded("time")
        return self._contacts

    def _recorded(self, name: str) -> NDArray[Any]:
        if self._trace:
            return self._trace[name]
        if self.error is not None:
            raise AttributeError(f"this run has no history: {self.error}", name=name, obj=self)
        message = "this run has no history: it was recorded with record='summary'"
        raise AttributeError(message, name=name, obj=self)

    def branch(
        self,
        at: float | Literal["stop"] = "stop",
        *,
        track: Track | None = None,
        friction: float | None = None,
        drive: Drive | None = None,
        duration: float | None = None,
        record: Recording = "full",
        sample_interval: float = 0.01,
    ) -> Run:
        """Go on from an instant of this run with something changed.

        The run is repeated up to that instant, bit by bit, and goes on from the same pose and
        speeds; what is not changed goes on as it was. Ground that is inside the new track is let
        out without a push: the track is dented there, and the dent heals as the robot moves on.

        Parameters
        ----------
        at : float or "stop"
            [s] When; "stop" is the instant of the diagnosis.
        track : track model, optional
            Another model of the robot's track.
        friction : float, optional
            [-] Another friction of the ground.
        drive : Drive, optional
            Another command.
        duration : float, optional
            [s] How long to go on; None takes that of the scenario, counted from the instant.
        record : {"full", "summary"}
            Whether to keep the history, or only outcome, metrics and events.
        sample_interval : float
            [s] Time between two samples of the history, rounded to whole time steps.

        Returns
        -------
        Run
            From that instant on; its stops, figures and outcome count from there.

        Raises
        ------
        ScenarioError
            If `at` is no time of the run, the run did not end in a stop, or is a branch itself, or
            a change breaks a rule.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4))
        >>> run = c2d.simulate(robot, c2d.terrains.step(0.10))
        >>> str(run.outcome), str(run.branch(track=c2d.BeltTrack()).outcome)
        ('seized', 'cleared')
        """
        time = branching.branch_time(self, at)
        changes = {"track": track, "friction": friction, "drive": drive, "duration": duration}
        variant = branching.branch_scenario(self, changes)
        result = branching.simulate_branch(self, time, variant, record, sample_interval)
        return Run(variant, result, trunk=(self.scenario, time))

    def counterfactual(
        self, at: float | Literal["stop"] = "stop", *, grousers: bool = False
    ) -> Counterfactual:
        """Try a closed belt in the pose of an instant: same envelope, force, friction and speeds.

        Parameters
        ----------
        at : float or "stop"
            [s] When; "stop" is the instant of the diagnosis.
        grousers : bool
            Whether the belt has grousers that travel with it, as `GrouserBeltTrack`: as high as
            those of the track, at the pitch of the outline. That is the fair one for gear wheels
            and shoes, whose grip a smooth belt has not. Where ground lies deeper inside than
            grousers are high, those that come to it hook on what no belt has inside: there an
            escape tells more than a failure, and of the smooth belt both tell.

        Returns
        -------
        Counterfactual
            Whether it gets away, and how far.

        Raises
        ------
        ScenarioError
            If `at` is no time of the run, the run did not end in a stop, or is a branch itself, or
            the track has no grousers where `grousers` asks for them.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4))
        >>> c2d.simulate(robot, c2d.terrains.step(0.10)).counterfactual().freed
        True
        """
        return branching.try_belt(self, branching.branch_time(self, at), grousers)

    def to_xarray(self) -> xarray.Dataset:
        """Copy the history to a labelled data set.

        Returns
        -------
        xarray.Dataset
            One variable an array, dimensions `time`, `axis` ("x", "y") and `drive`, units in the
            attributes; outcome, metrics and scenario are attributes of the set.

        Raises
        ------
        ImportError
            If xarray is missing; the message names the extra to install.
        AttributeError
            If the run was recorded with ``record="summary"``.
        """
        from crawler2d.labelled import to_dataset  # noqa: PLC0415 - optional

        return to_dataset(self)

    def plot(
        self, time: ArrayLike | None = None, *, axes: Axes | tuple[Axes, ...] | None = None
    ) -> tuple[Axes, ...]:
        """Draw the side view, and chassis angle, track speed and drive force over time.

        Parameters
        ----------
        time : array_like, shape (k,), optional
            [s] When to draw the robot; None takes about one robot length between drawings.
        axes : Axes or tuple of 4 Axes, optional
            Where to draw: one Axes takes the side view alone. None makes a figure.

        Returns
        -------
        tuple of Axes
            Side view, chassis angle, track speed, drive force; or the side view alone.

        Raises
        ------
        ImportError
            If matplotlib is missing; the message names the extra to install.
        AttributeError
            If the run was recorded with ``record="summary"``.
        """
        from crawler2d.plotting import plot_run  # noqa: PLC0415 - optional

        return plot_run(self, time, axes)

    @overload
    def to_html(self, path: None = None, *, time: float | None = None) -> str: ...

    @overload
    def to_html(self, path: str | PathLike[str], *, time: float | None = None) -> Path: ...

    def to_html(
        self, path: str | PathLike[str] | None = None, *, time: float | None = None
    ) -> str | Path:
        """Write one HTML page that replays the run; it needs no network and no other file.

        A run of more than 3000 samples is thinned to at most so many, and the page says so.

        Parameters
        ----------
        path : str or path-like, optional
            Where to write the page; None returns its text.
        time : float, optional
            [s] Instant that the page opens at; None takes the end where the run stopped, else the
            beginning.

        Returns
        -------
        str or Path
            The text, or the path of the written file.

        Raises
        ------
        OSError
            If the file cannot be written.
        AttributeError
            If the run was recorded with ``record="summary"``.
        """
        # They cost nothing until used.
        from pathlib import Path  # noqa: PLC0415

        from crawler2d.viewer import replay_page  # noqa: PLC0415

        text = replay_page(self, time)
        if path is None:
            return text
        Path(path).write_text(text, encoding="utf-8", newline="\n")
        return Path(path)

    def _repr_html_(self) -> str:
        """Replay the run in a notebook, or show its figures where there is no history."""
        from crawler2d.viewer import embedded  # noqa: PLC0415 - costs nothing until used

        return embedded(self)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the data; arrays are read-only again in the copy."""
        result = {
            "outcome": self.outcome,
            "diagnosis": None if self.diagnosis is None else self.diagnosis.to_plain(),
            "metrics": self.metrics,
            "edges": dict(self.edges),
            "events": dict(self.events),
            "wall_time": self.wall_time,
            "trace": self._trace,
            "contacts": dict(self._contacts),
        }
        return Run, (self.scenario, result, self.error, self.trunk)

    def __repr__(self) -> str:
        """Say what ran and how it ended."""
        return f"Run({self.title})"

    @property
    def title(self) -> str:
        """What ran and how it ended, in one line for tables and plots."""
        robot, terrain = self.scenario.robot, self.scenario.terrain
        names = (
            getattr(robot, "name", robot),
            _kind(getattr(robot, "track", None)),
            _kind(terrain),
        )
        subject = ", ".join(str(name) for name in names)
        if self.error is not None:
            return f"{subject}: {type(self.error).__name__}"
        return f"{subject}: {self.outcome} after {self.metrics['time']:.2f} s"


def _kind(part: object) -> str:
    # A scenario that was refused may hold anything here.
    return str(getattr(part, "kind", type(part).__name__))
