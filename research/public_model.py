"""The public wheel model of the Engineer, and a post that fits between its wheels."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.parameters.scenario import Scenario
from crawler2d.presets import terrains
from crawler2d.presets.robots import engineer
from crawler2d.runs.batch import simulate_many

if TYPE_CHECKING:
    from collections.abc import Mapping

    from crawler2d.runs.run import Run

__all__ = ["Post", "posts", "public_wheel_model"]

_POST_THICKNESS = 0.020
_HEIGHTS = (0.03, 0.05, 0.08)


@dataclass(frozen=True, slots=True, kw_only=True)
class Post:
    """A time span in which the post was between two wheels."""

    height: float
    """[m]"""
    belly: bool
    """Whether the robot has a belly."""
    outcome: str
    mechanism: str
    """How the post is held if the run ended in a stop; "" if it did not."""
    bodies: str
    """The two wheels, in order of belt travel; wheel 2 is the foremost."""
    start: float
    """[s]"""
    end: float
    """[s]"""
    depth: float
    """[m] Largest depth inside the taut belt round the wheels."""
    force: float
    """[N] Mean normal force on the post."""


def public_wheel_model(threads: int | None = None) -> dict[tuple[float, bool], Run]:
    """Drive the public wheel model of the Engineer against posts, with and without a belly.

    The wheels are those of the public simulation model; robot, friction and speed are those of the
    study, so that only the track differs.

    Parameters
    ----------
    threads : int, optional
        See `simulate_many`.

    Returns
    -------
    dict of (float, bool) to Run
        Runs with history, by the height of the post [m] and whether the robot has a belly.
    """
    robot = engineer(flippers=None, track="public").without_rotors()
    robots = {True: robot, False: replace(robot, belly=None)}
    places = [(height, belly) for belly in robots for height in _HEIGHTS]
    scenarios = [
        Scenario(robots[belly], terrains.barrier(height, _POST_THICKNESS))
        for height, belly in places
    ]
    return dict(zip(places, simulate_many(scenarios, threads=threads), strict=True))


def posts(runs: Mapping[tuple[float, bool], Run]) -> list[Post]:
    """List the time spans in which the post was between two different wheels.

    Parameters
    ----------
    runs : mapping of (float, bool) to Run
        What `public_wheel_model` returned.

    Returns
    -------
    list of Post
        In the order of runs and events.

    Examples
    --------
    >>> first = posts(public_wheel_model())[0]
    >>> first.bodies, round(first.depth, 3)
    ('2 1', 0.03)
    """
    return [
        Post(
            height=height,
            belly=belly,
            outcome=str(run.outcome),
            mechanism=str(run.mechanism or ""),
            bodies=" ".join(map(str, run.events["bodies"][row])),
            start=float(run.events["start"][row]),
            end=float(run.events["end"][row]),
            depth=float(run.events["depth"][row]),
            force=float(run.events["force"][row]),
        )
        for (height, belly), run in runs.items()
        for row in np.flatnonzero(run.events["kind"] == "intrusion")
        if len(set(run.events["bodies"][row])) == 2
    ]
