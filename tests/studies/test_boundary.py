"""The boundary of a rate along one field: tried at both ends, inside, and where it crosses."""

import math
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.studies.boundary import Crossing, Line
from tests.shared import ROBOT

SLOPE = c2d.Scenario(ROBOT, c2d.terrains.ramp(math.atan(0.5)))
STEADY: dict[str, Any] = {"vary": {"start.track_phase": c2d.uniform(0.0, 0.048)}, "progress": False}


def friction_of(**how: Any) -> Any:
    return c2d.studies.critical_value(
        SLOPE, "terrain.friction", (0.3, 0.8), points=3, **STEADY, **how
    )


def test_a_belt_climbs_where_friction_exceeds_the_slope() -> None:
    found = friction_of(tolerance=0.002)
    low, high = found["bracket_low"].item(), found["bracket_high"].item()
    assert 0.0 < high - low <= 0.002
    # The tangent of the slope; its one metre is so short that the run-up makes a per cent.
    assert low == pytest.approx(0.5, abs=0.01)
    assert found["rises"].item()
    assert found["monotone"].item()
    tried = found["friction"].to_numpy()
    assert {0.3, 0.55, 0.8} <= set(tried.round(9))
    rates = found["rate"].to_numpy()[0]
    assert (rates[tried <= low] == 0.0).all()
    assert (rates[tried >= high] == 1.0).all()


def test_every_model_and_sample_has_its_own_bracket() -> None:
    models = {"as it is": {}, "half": {"robot.drivetrain.max_torque": 3.0}}
    unknown = {"robot.mass": c2d.uniform(18.0, 24.0)}
    found = friction_of(models=models, unknown=unknown, samples=2, tolerance=0.05)
    assert found["bracket_low"].dims == ("model", "sample")
    assert found["bracket_low"].sel(model="as it is").notnull().all()
    assert found["rate"].dims == ("model", "friction", "sample")


def test_where_a_model_was_not_tried_nothing_was_drawn() -> None:
    models = {"as it is": {}, "weak": {"robot.drivetrain.max_torque": 0.5}}
    how: dict[str, Any] = {"unknown": {"robot.mass": c2d.uniform(18.0, 24.0)}, "samples": 2}
    found = friction_of(
        models=models, tolerance=0.2, until=c2d.Until(min_runs=1, max_runs=1), **how
    )
    is_tried = found["count"] > 0
    assert not is_tried.all()
    assert (found["unknown_mass"].notnull() == is_tried).all()


def test_without_a_crossing_of_one_half_there_is_no_bracket() -> None:
    found = c2d.studies.critical_value(SLOPE, "terrain.friction", (0.1, 0.3), points=2, **STEADY)
    assert math.isnan(found["bracket_low"].item())
    assert found["monotone"].item()
    assert found.attrs["settings"] == 2


def test_monotone_is_a_rate_that_passes_one_half_once() -> None:
    edge = c2d.Scenario(
        c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(5)),
        c2d.terrains.step(0.05),
        drive=c2d.Drive(speed=0.2),
    )
    found = c2d.studies.critical_value(edge, "terrain.height", (0.02, 0.16), points=8, **STEADY)
    ways = found["rate"].sel(model=found["model"].values[0]).to_numpy() >= 0.5
    ways = ways[found["count"].to_numpy()[0] > 0]
    assert found["monotone"].item() == (np.count_nonzero(np.diff(ways)) <= 1)


def test_invalid_arguments_are_refused_by_name() -> None:
    cases: list[tuple[tuple[Any, ...], dict[str, Any], str]] = [
        (("robot.name", (0.1, 0.2)), {}, "path"),
        (("terrain.friction", (0.2, 0.1)), {}, "between"),
        (("terrain.friction", 0.1), {}, "between"),
        (("terrain.friction", ("a", 0.1)), {}, "between[0]"),
        (("terrain.friction", (0.1, 0.2)), {"tolerance": 0.0}, "tolerance"),
        (("terrain.friction", (0.1, 0.2)), {"points": 1}, "points"),
    ]
    for given, how, path in cases:
        with pytest.raises(c2d.ScenarioError) as caught:
            c2d.studies.critical_value(SLOPE, *given, **how)
        assert caught.value.path == path


def test_a_model_that_breaks_a_rule_is_refused_before_any_run() -> None:
    made: list[int] = []
    models: dict[str, Any] = {"as it is": {}, "weightless": {"robot.mass": -1.0}}
    how = {**STEADY, "models": models, "progress": lambda done, _: made.append(done)}
    with pytest.raises(c2d.ScenarioError, match=r"model=weightless, .*robot.mass must be"):
        c2d.studies.critical_value(SLOPE, "terrain.friction", (0.3, 0.8), points=3, **how)
    assert set(made) <= {0}


def test_halving_ends_where_there_is_no_number_between() -> None:
    once = c2d.Until(min_runs=1, max_runs=1)
    found = friction_of(tolerance=1e-18, until=once)
    low, high = found["bracket_low"].item(), found["bracket_high"].item()
    assert 0.5 * (low + high) in (low, high)


class Rates(Line):
    """A line with given rates; added values have no result."""

    def __init__(self, rates: dict[float, float]) -> None:
        nothing: Any = None
        super().__init__(nothing, ("", ""), nothing)
        self._rates: dict[float, float] = {}
        self._take(rates)

    def _take(self, rates: dict[float, float]) -> None:
        self._rates |= rates
        tallies: Any = {value: [None] for value in rates}
        self.tallies |= tallies

    def add(self, values: Any) -> None:
        self._take(dict.fromkeys(values, math.nan))

    def rates(self, sample: int = 0) -> dict[float, float]:
        assert sample == 0
        return dict(sorted(self._rates.items()))


def test_a_value_without_a_result_is_no_rate_below_one_half() -> None:
    assert Rates({0.0: 1.0, 1.0: math.nan, 2.0: 1.0}).crossing() == Crossing()
    line = Rates({0.0: 0.0, 1.0: math.nan, 2.0: 1.0})
    line.narrow(0.5)
    assert line.crossing()[:3] == (0.0, 2.0, True)
