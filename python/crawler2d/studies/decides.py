"""Which of the unknowns decides whether the robot gets over, and where each of them does."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Unpack

from crawler2d.common.arrays import whole_number
from crawler2d.common.extras import extra
from crawler2d.common.keywords import takes_keywords
from crawler2d.errors import ScenarioError
from crawler2d.parameters.scenario import Scenario
from crawler2d.studies.along import check_ends, line_over, range_of
from crawler2d.studies.campaign import How, campaign, counting
from crawler2d.studies.decided import Answer, decided
from crawler2d.studies.design import Design
from crawler2d.studies.models import Models, read_models
from crawler2d.variation.draws import Variation

if TYPE_CHECKING:
    from crawler2d.sweeps.found import Found

__all__ = ["what_decides"]

_FEWEST, _MOST = 32, 2**16
"""Points of a design."""


@takes_keywords
def what_decides(
    scenario: Scenario,
    *,
    models: Models | None = None,
    outcome: str = "cleared",
    **how: Unpack[How],
) -> Found:
    """Find which of the unknowns decides whether the robot gets over.

    The outcome differs between runs because of what is not known of robot and floor, and because of
    what varies from run to run. Sobol indices say how much of that variance comes from each: of
    each unknown, and of all that varies from run to run together, drawn independently of each
    other. They are estimated from runs of their own: of n such factors, n + 2 times `samples`. Then
    each unknown is moved over its range, all others as in the scenario, to find where the rate
    passes one half.

    Parameters
    ----------
    scenario : Scenario
        What all runs share.
    models : mapping of str to track or fields, optional
        As for `compare`; None takes the scenario's own robot.
    outcome : str
        Name of an `Outcome`, or "stopped" for any stop.
    **how
        See `crawler2d.studies`. `unknown` must be given. `samples`, a power of two from 32 to
        65536, is 256 unless given. `until` is for the rates along the ranges; its confidence is
        that of the indices, too.

    Returns
    -------
    Found
        Dimensions `model`; `unknown`, by the last part of its path, and last "run to run" if
        anything varies; `place`, the values that were tried of each; and `matrix` and `sample`, the
        points of the design: A, B, and A with one factor of B. For each model and unknown:

        - `first`: the share of the variance that would go if this one were known; `total`: the
          share that would be left if all others were; with `..._low` and `..._high`. The
          difference is what it decides together with others. An estimate may lie below 0;
        - `bracket_low`, `bracket_high`, `rises`, `monotone`: as of `critical`, over the range of
          the distribution (1 to 99 % of an unbounded one), all elements of a path with ``[*]``
          together, the first of which is told; nan also for whole numbers and for "run to run";
        - `range_low`, `range_high`, `own`: ends of the range, and the scenario's own value;
        - `tried`, `tried_rate`: the values along the range, and the rate at each.

        For each model: `rate` over all that varies or is not known, of `count` runs; and `caveat`,
        empty if the indices are there. They are nan where the rate is not from 0.1 to 0.9, because
        too few runs end otherwise than the others; then only those for the rate are made. `outcome`
        is that of every run of the design, "" of those that were not made; a store keeps the runs.

        `plot` draws the indices of one model, and ``plot(show="boundary")`` the ranges.

    Raises
    ------
    ScenarioError
        If an argument breaks a rule, or a value in the range of an unknown does.
    SimulationDiverged
        If a run of the design has no result.
    ImportError
        If SciPy or xarray is missing; the message names the extra to install.

    References
    ----------
    Sobol, I. M. (2001). Global sensitivity indices for nonlinear mathematical models and their
    Monte Carlo estimates. Mathematics and Computers in Simulation 55, 271-280. How they are
    estimated is told in `crawler2d.studies.indices`, and how often intervals held indices that are
    known in the attribute `coverage`.

    Examples
    --------
    Whether a belt climbs a slope is decided by friction; motors that are strong enough matter no
    more:

    >>> import math
    >>> import crawler2d as c2d
    >>> robot = c2d.robots.engineer(flippers=None)
    >>> base = c2d.Scenario(robot, c2d.terrains.ramp(math.atan(0.7)))
    >>> unknown = {
    ...     "terrain.friction": c2d.uniform(0.5, 1.0),
    ...     "robot.drivetrain.max_torque": c2d.uniform(30.0, 40.0),
    ... }
    >>> until = c2d.Until(threshold=0.5, least=5, most=10)  # quick
    >>> found = c2d.studies.what_decides(
    ...     base, unknown=unknown, samples=32, until=until, progress=False
    ... )
    >>> found["unknown"].values.tolist()
    ['friction', 'max_torque', 'run to run']
    >>> found["first"].values.round(1).tolist()
    [[1.0, 0.0, 0.0]]
    >>> round(found["bracket_low"].sel(unknown="friction").item(), 2)
    0.7
    """
    extra("xarray", "analysis")
    extra("scipy.stats", "sensitivity")  # fail before the runs if it is missing
    counts = counting(outcome)
    samples = _power_of_two(how.get("samples", 256))
    fields = read_models(scenario, models)
    swept = list(dict.fromkeys(key for each in fields.values() for key in each))
    unknowns = _unknowns(scenario, how.pop("unknown", None), swept)
    how.pop("samples", None)
    with campaign(scenario, how, [*swept, *unknowns.distributions], threshold=0.5) as study:
        if len(unknowns.distributions) < 2 and not study.planner.variation.distributions:
            rule = "must have two paths or more, because nothing varies from run to run"
            raise ScenarioError("unknown", unknowns.text, rule)
        design = Design(study, unknowns, samples, counts)
        cells = {label: scenario.replace(own) for label, own in fields.items()}
        ranges = {
            (label, name): range_of(unknowns, path, cell)
            for label, cell in cells.items()
            for path, name in design.factors.items()
        }
        for (label, name), along in ranges.items():
            check_ends(study, along, (f"model={label}", name))
        answers = []
        for label, cell in cells.items():
            matrices = design.run(cell, str(label))
            lines = []
            for name in design.factors.values():
                along = ranges[label, name]
                line = line_over(study, along, (f"model={label}", name), counts)
                lines.append((along, line))
            answers.append(Answer(matrices, lines))
        return decided(study, design, list(fields), answers, outcome)


def _power_of_two(value: object) -> int:
    number = whole_number(value, "samples", _FEWEST, _MOST)
    if number & (number - 1):
        raise ScenarioError("samples", number, "must be a power of two")
    return number


def _unknowns(scenario: Scenario, given: object, swept: list[str]) -> Variation:
    if not given or not isinstance(given, Mapping):
        rule = "must be a mapping from paths to distributions, such as unknowns.of_ground()"
        raise ScenarioError("unknown", given, rule)
    return Variation.of(scenario, given, swept, "unknown")
