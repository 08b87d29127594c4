"""Outcomes of runs, and the terms of a diagnosis with their meanings."""

from __future__ import annotations

from enum import StrEnum

from crawler2d import _core

__all__ = ["MECHANISMS", "OUTCOMES", "TRIALS", "Outcome", "glossary_text", "rate_label"]

OUTCOMES = {
    "detracked": "a chain of shoes came off its guide or its wheels",
    "tipped_over": "the chassis tilted by more than criteria.tip_over_angle",
    "left_terrain": "an end axle went beyond the end of the ground, or a metre below all of it",
    "cleared": "the robot is past the goal",
    "seized": "stopped with ground jammed in a track; closed, that track gets free",
    "cycling": "stopped, moving back and forth by more than criteria.cycling_distance",
    "hung_up": "stopped with criteria.belly_load of the load or more on the belly",
    "stalled": "stopped with at least half of the motors on the ground at their torque limit",
    "slipping": "stopped while the track slips",
    "timed_out": "the time was over while it was moving or was to stand, or in a transient stop",
}
"""Outcomes of a run; if several apply, the first."""

_ENDING = {
    "detracked": "throwing the track",
    "tipped_over": "tipping over",
    "left_terrain": "leaving the terrain",
    "cleared": "clearing",
    "seized": "seizing",
    "hung_up": "hanging up",
    "stalled": "stalling",
    "timed_out": "timing out",
    "stopped": "stopping",
}

MECHANISMS = {
    "fouled": "the guide or the wheels that a chain of shoes runs on rest on it",
    "pinched": "the gap between two shoes of a chain closes on it",
    "interlocked": "the motors are at their torque limit, a grouser's flank is against it",
    "blocked": "the motors are at their torque limit",
    "straddled": "two bodies of the track bear on it",
    "undercut": "one body bears on it and slides at its friction limit",
}
"""How the most loaded ground inside a track is held; the first that applies."""

TRIALS = {
    "unchanged": "the run goes on: a control",
    "rebuilt": "its own track is built again in this pose: a control for the next trials",
    "closed track": "a belt round the bodies of each track, with grousers if the model has some",
    "closed track, clear of the ground": (
        "the same belt, at rest in the nearest pose in which no ground is inside it"
    ),
    "closed smooth track": "a belt without grousers round the bodies of each track",
    "belt": "a belt along the outlines of chassis and flippers, wherever the model has its bodies",
    "belt, from the start": "the same where the run began",
    "closed track, from the start": "the closed track where the run began",
    "one motor": "one motor for each track in place of one for each wheel",
    "torque x 2": "twice the torque limit",
    "torque x 10": "ten times the torque limit",
    "friction x 2": "twice the friction",
    "no belly": "the belly is taken off",
    "flippers level": "the flippers turn to angle 0",
}
"""The change that each trial makes at a stop."""


def rate_label(outcome: str) -> str:
    """Name the rate of an outcome, for labels.

    Examples
    --------
    >>> rate_label("cleared"), rate_label("slipping")
    ('rate of clearing', 'rate of slipping')
    """
    return f"rate of {_ENDING.get(outcome, outcome)}"


def glossary_text(words: dict[str, str], indent: str = "") -> str:
    """List terms and meanings for a docstring, with all lines but the first indented."""
    return f"\n{indent}".join(f"- {word}: {meaning}" for word, meaning in words.items())


class Outcome(StrEnum):
    """How a run ended; if several apply, the first in this list.

    {meanings}

    Examples
    --------
    >>> [str(outcome) for outcome in Outcome if outcome.is_stop]
    ['seized', 'cycling', 'hung_up', 'stalled', 'slipping']
    """

    DETRACKED = "detracked"
    TIPPED_OVER = "tipped_over"
    LEFT_TERRAIN = "left_terrain"
    CLEARED = "cleared"
    SEIZED = "seized"
    CYCLING = "cycling"
    HUNG_UP = "hung_up"
    STALLED = "stalled"
    SLIPPING = "slipping"
    TIMED_OUT = "timed_out"

    @property
    def is_stop(self) -> bool:
        """Whether the robot made no progress despite its command."""
        return self in _STOPS

    @property
    def meaning(self) -> str:
        """What it means, in a few words."""
        return OUTCOMES[self.value]


if Outcome.__doc__ is not None:  # not so with python -OO
    Outcome.__doc__ = Outcome.__doc__.replace("{meanings}", glossary_text(OUTCOMES, "    "))

_STOPS = frozenset(_core.kinds()["stop"])
