"""A figure of driving for every model, with what limits it: what `max_speed` and others share."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.common.arrays import real_number
from crawler2d.errors import ScenarioError
from crawler2d.parameters.scenario import Scenario
from crawler2d.studies.campaign import Sampling, campaign
from crawler2d.studies.limits import FRICTION, TORQUE, UNCHANGED, Change, limits
from crawler2d.studies.models import Models, read_models
from crawler2d.studies.steady import Halt, RunUp, drive, on_plane
from crawler2d.studies.tables import Dims, Measure, measured_of
from crawler2d.variation.ranges import Ranges
from crawler2d.variation.variability import of_contact, of_start

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.sweeps.found import Found

__all__ = ["Asked", "Figure", "limited"]

_SHARE = 0.02
"""[-] A change that moves a figure by less is no limit of it."""
_OWN = ("drive.speed", "drive.schedule", "duration", "goal")
"""What these studies set themselves."""
_COMMANDED = (*_OWN, "robot.drivetrain.max_speed")
"""What may not be drawn: commanded is the largest speed."""
_PARTS = ("run-up", "one window", "two windows", "stop", "rest")


@dataclass(frozen=True, slots=True)
class Figure:
    """One figure of driving.

    Attributes
    ----------
    study, name, units, long_name : str
        Names of study and column, unit, and what it is in words.
    command : Change
        Which inputs are its command.
    least : float
        [units] A change below this is none.
    values : callable
        Takes a finished run-up, and a stop from there if it `halts`; gives the figure, shape
        (samples, repeats).
    halts : bool
        Whether the robot stops; then less is better.
    """

    study: str
    name: str
    units: str
    long_name: str
    command: Change
    least: float
    values: Callable[[RunUp, Halt | None], NDArray[np.float64]]
    halts: bool = False


@dataclass(frozen=True, slots=True)
class Asked:
    """What is asked of a study: models, commanded speed [m/s] and number of repeats."""

    models: Models | None
    speed: float | None
    repeats: int


def limited(figure: Figure, scenario: Scenario, asked: Asked, how: Sampling) -> Found:
    """Drive every model as it is and with each change, and arrange what came of it."""
    if not isinstance(scenario, Scenario):
        raise ScenarioError("scenario", scenario, "must be a Scenario")
    given = None if asked.speed is None else real_number(asked.speed, "speed")
    if given is not None and not given > 0.0:
        raise ScenarioError("speed", given, "must be above 0")
    fields = read_models(scenario, asked.models)
    for label, own in fields.items():
        _refuse_own(own, f"models[{label!r}]")
    changes = (UNCHANGED, figure.command, TORQUE, FRICTION)
    with campaign(on_plane(scenario, given), _sampling(how), repeats=asked.repeats) as study:
        run_ups = [
            RunUp(
                (f"model={label}", f"change={change.label}"),
                change.of(on_plane(scenario.replace(own), given)),
                change.factors,
            )
            for label, own in fields.items()
            for change in changes
        ]
        drive(study, run_ups)
        halts = [Halt(each) if figure.halts else None for each in run_ups]
        drive(study, [halt for halt in halts if halt is not None])
        driven = list(zip(run_ups, halts, strict=True))
        shape = (len(fields), len(changes), -1, study.until.most)
        values = np.array([figure.values(*both) for both in driven]).reshape(shape)
        speeds = np.array([run_up.speed for run_up in run_ups]).reshape(shape)
        measures = {
            figure.name: Measure(("model",), values[:, 0], figure.units, figure.long_name),
            f"{figure.name}_with": Measure(
                ("model", "change"), values, figure.units, f"{figure.long_name} with each change"
            ),
        }
        if figure.name != "speed":
            measures["speed"] = Measure(("model",), speeds[:, 0], "m/s", "steady speed")
        dims: Dims = {
            "model": (list(fields), {}),
            "change": ([each.label for each in changes], {"long_name": "what is doubled"}),
            "part": (_PARTS[: 3 + 2 * figure.halts], {"long_name": "how far a run goes"}),
        }
        tallies = [part for both in driven for course in both if course for part in course.tallies]
        found = measured_of(study, figure.study, tallies, dims, measures)
    limit = limits(values, changes, share=_SHARE, least=figure.least, falls=figure.halts)
    ended = np.array([(halt or run_up).ended for run_up, halt in driven])
    one, every = found[figure.name], found[f"{figure.name}_with"]
    meanings = {change.name: change.meaning for change in changes[1:]}
    told = {"long_name": "what limits it, found by doubling each", "share": _SHARE, **meanings}
    how_ended = {"long_name": "how most of the longest runs ended"}
    return found.assign(
        limit=(one.dims, limit.reshape(one.shape), told),
        ended=(every.dims, ended.reshape(every.shape), how_ended),
    )


def _refuse_own(given: object, place: str) -> None:
    """Refuse fields that the study sets itself."""
    for path in given if isinstance(given, Mapping) else ():
        if path in _OWN:
            rule = f"must not have {path}, which the study sets; a speed is given by speed="
            raise ScenarioError(place, path, rule)


def _sampling(how: Sampling) -> Sampling:
    """Take what the study commands out of what is drawn, or refuse it."""
    drawn = how.get("vary")
    vary = of_start() | of_contact() if drawn is None else drawn
    if isinstance(vary, Ranges):
        gone = [path for path in _COMMANDED if path in vary.gives_way]
        kept = {path: each for path, each in vary.items() if path not in gone}
        vary = Ranges(kept, vary.sources, vary.gives_way.difference(gone))
    for name, given in (("vary", vary), ("unknown", how.get("unknown"))):
        drawn_too = given if isinstance(given, Mapping) else {}
        for path in _COMMANDED:
            if path in drawn_too:
                rule = "must not draw what the study commands: give models for other speeds"
                raise ScenarioError(f"{name}[{path!r}]", drawn_too[path], rule)
    return {**how, "vary": vary}
