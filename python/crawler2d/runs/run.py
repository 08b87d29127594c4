"""What came out of a run, and what can be done with it: branch, draw, replay, export."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, overload

from crawler2d.results.record import Record
from crawler2d.runs import branch as branching
from crawler2d.runs.recording import Recording

if TYPE_CHECKING:
    from os import PathLike
    from pathlib import Path

    import xarray
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike

    from crawler2d.parameters.settings import Drive
    from crawler2d.parameters.track import Track
    from crawler2d.results.findings import Counterfactual

__all__ = ["Run"]


class Run(Record):
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
    `solves`                 -      searches for the forces that all contacts, motors and pins agree
                                    on
    `solve_rounds`           -      linear systems solved in them: one a solve where the first guess
                                    of what sticks and what slides fits
    `descents`               -      solves in which guesses could not be mended and a descent took
                                    over
    `unresolved_solves`      -      solves that ended without agreement: their friction was cut
                                    until it added no energy
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
        from crawler2d.runs.labelled import to_dataset  # noqa: PLC0415 - optional

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
        from crawler2d.pictures.plotting import plot_run  # noqa: PLC0415 - optional

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

        from crawler2d.pictures.page import replay_page  # noqa: PLC0415

        text = replay_page(self, time)
        if path is None:
            return text
        Path(path).write_text(text, encoding="utf-8", newline="\n")
        return Path(path)

    def _repr_html_(self) -> str:
        """Replay the run in a notebook, or show its figures where there is no history."""
        from crawler2d.pictures.page import embedded  # noqa: PLC0415 - costs nothing until used

        return embedded(self)
