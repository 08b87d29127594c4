"""Arguments that every study refuses before any run."""

import importlib
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import crawler2d as c2d
from tests.shared import refused

ROBOT: Any = c2d.robots.engineer(flippers=None)
STUDIES: dict[str, Callable[[Any], Any]] = {
    "certify": lambda scenario: c2d.studies.certify(scenario, {"terrain.friction": (0.3, 0.8)}),
    "compare": lambda scenario: c2d.compare(scenario, {"as it is": {}}),
    "critical_value": lambda scenario: c2d.studies.critical_value(
        scenario, "terrain.friction", (0.3, 0.8)
    ),
    "jam_chart": c2d.studies.jam_chart,
    "max_gap": c2d.studies.max_gap,
    "max_obstacle": c2d.studies.max_obstacle,
    "max_slope": c2d.studies.max_slope,
    "odometry": c2d.studies.odometry,
    "ride": c2d.studies.ride,
    "seizure_map": lambda scenario: c2d.studies.seizure_map(
        scenario, ("terrain.height", [0.1, 0.2]), ("terrain.friction", [0.3, 0.6])
    ),
    "success_rate": c2d.studies.success_rate,
    "sensitivity": c2d.studies.sensitivity,
}


@pytest.mark.parametrize("name", STUDIES)
@pytest.mark.parametrize("given", [ROBOT, None])
def test_a_study_of_something_else_than_a_scenario_is_refused(name: str, given: Any) -> None:
    with pytest.raises(c2d.ScenarioError, match="scenario must be a Scenario"):
        STUDIES[name](given)


def test_where_a_robot_or_scenario_is_needed_a_reading_is_answered_with_its_robot() -> None:
    reading: Any = c2d.read_robot(c2d.samples.path())
    step = c2d.terrains.step(0.05)
    with_robot: tuple[Any, ...] = (c2d.simulate, c2d.jams, c2d.Scenario)
    for call in with_robot:
        with pytest.raises(c2d.ScenarioError, match=r"Robot, got .*; use reading\.robot$"):
            call(reading, step)
    with_scenario: tuple[Any, ...] = (c2d.Simulation, c2d.studies.max_obstacle)
    for call in with_scenario:
        with pytest.raises(c2d.ScenarioError, match=r": write Scenario\(reading.robot, terrain\)$"):
            call(reading)


@pytest.mark.parametrize("name", sorted(set(STUDIES) - {"certify", "compare"}))
def test_a_study_without_xarray_names_its_extra_before_anything_runs(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing(module: str) -> None:
        raise ModuleNotFoundError(f"No module named {module!r}", name=module)

    monkeypatch.setattr(importlib, "import_module", missing)
    with pytest.raises(ImportError, match=r"crawler2d\[analysis\]"):
        STUDIES[name](c2d.Scenario(ROBOT, c2d.terrains.step(0.05)))


@pytest.mark.parametrize(
    ("study", "rule"),
    [
        (c2d.studies.max_obstacle, "must be a terrain with a height"),
        (c2d.studies.max_slope, "must be a terrain with an angle"),
        (c2d.studies.max_gap, "must be a terrain with a width"),
    ],
)
def test_flat_ground_has_no_greatest_obstacle(study: Callable[[Any], Any], rule: str) -> None:
    with pytest.raises(c2d.ScenarioError, match=f"terrain {rule}"):
        study(c2d.Scenario(ROBOT, c2d.terrains.flat()))


@pytest.mark.parametrize("given", [5, None, ("terrain.height",)])
def test_a_path_that_is_no_text_is_refused_by_the_name_of_its_argument(given: Any) -> None:
    base = c2d.Scenario(ROBOT, c2d.terrains.step(0.05))
    cases: list[tuple[str, Callable[[], Any]]] = [
        ("path", lambda: c2d.studies.critical_value(base, given, (0.3, 0.8))),
        ("over", lambda: c2d.studies.certify(base, {given: (0.3, 0.8)})),
        ("x", lambda: c2d.studies.jam_chart(base, x=given, values=[0.1])),
    ]
    for name, study in cases:
        with pytest.raises(c2d.ScenarioError, match="must be the path of a real number") as caught:
            study()
        assert caught.value.path == name


@pytest.mark.parametrize("given", [0.05, "0.05", [], ["low"], [None]])
def test_values_that_are_no_numbers_are_refused_by_name(given: Any) -> None:
    base = c2d.Scenario(ROBOT, c2d.terrains.step(0.05))
    cases: list[tuple[str, Callable[[], Any]]] = [
        ("heights", lambda: c2d.studies.max_obstacle(base, heights=given)),
        ("values", lambda: c2d.studies.jam_chart(base, values=given)),
        (
            "x[1]",
            lambda: c2d.studies.seizure_map(
                base, ("terrain.height", given), ("terrain.friction", [0.3, 0.6])
            ),
        ),
    ]
    for path, study in cases:
        with pytest.raises(c2d.ScenarioError) as caught:
            study()
        assert caught.value.path.removesuffix("[0]") == path


def test_a_single_run_or_scenario_is_no_list_of_them() -> None:
    scenario: Any = c2d.Scenario(ROBOT, c2d.terrains.flat(), duration=0.1)
    with pytest.raises(c2d.ScenarioError, match="scenarios must be several"):
        c2d.simulate_many(scenario)
    with pytest.raises(c2d.ScenarioError, match="table must be what sweep or table returned"):
        c2d.rate(c2d.simulate(scenario))  # type: ignore[arg-type]
    with pytest.raises(c2d.ScenarioError, match="runs must be several"):
        c2d.table(c2d.simulate(scenario))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "given",
    [
        "study.sqlite",
        "cleared",
        xr.DataArray([["cleared"]]),
        pd.DataFrame({"outcome": ["cleared"]}),
    ],
)
def test_rate_refuses_paths_and_frames_by_the_name_of_its_argument(given: Any) -> None:
    rule = "table must be what sweep or table returned, or outcomes in a list"
    with pytest.raises(c2d.ScenarioError, match=rule):
        c2d.rate(given)


@pytest.mark.parametrize("given", [np.array(2), np.array("x"), np.array(None), np.ma.masked])
def test_an_array_without_dimensions_is_no_list(given: Any, tmp_path: Path) -> None:
    run = c2d.simulate(ROBOT, c2d.terrains.flat(), duration=0.0)
    cases: list[tuple[str, Callable[[], Any]]] = [
        ("scenarios", lambda: c2d.simulate_many(given)),
        ("scenarios", lambda: c2d.Simulations(given)),
        ("table", lambda: c2d.rate(given)),
        ("runs", lambda: c2d.table(given)),
        ("axes", lambda: run.plot_history(given)),
        ("tracks", lambda: c2d.read_robot(tmp_path, tracks=given)),
    ]
    for name, call in cases:
        with pytest.raises(c2d.ScenarioError) as caught:
            call()
        assert caught.value.path == name


def test_repeats_of_a_study_of_measures_are_a_number() -> None:
    base = c2d.Scenario(ROBOT, c2d.terrains.flat(), duration=0.1)
    none: Any = None
    for study in (c2d.studies.ride, c2d.studies.odometry, c2d.studies.max_speed):
        with pytest.raises(c2d.ScenarioError, match=r"^repeats must be a whole number from 1"):
            study(base, repeats=none, progress=False)


def test_fields_that_differ_in_their_seed_alone_get_a_warning_where_runs_draw_it() -> None:
    # Each row of the result is the same: every run on either has its own field.
    base = c2d.Scenario(ROBOT, c2d.terrains.flat(), duration=0.1)
    fields = {f"field {seed}": c2d.terrains.random_stepfield(seed) for seed in (1, 2)}
    few: Any = {"until": c2d.Until(min_runs=1, max_runs=1), "progress": False}
    with pytest.warns(c2d.ScenarioWarning, match="their seed.*got field 1, field 2$"):
        c2d.studies.success_rate(base, terrains=fields, **few)
    with warnings.catch_warnings():
        warnings.simplefilter("error", c2d.ScenarioWarning)
        c2d.studies.success_rate(base, terrains=fields, vary=c2d.variability.of_start(), **few)
        lower = c2d.terrains.random_stepfield(rise=0.01)
        c2d.studies.success_rate(base, terrains={**fields, "field 2": lower}, **few)


MEASURES = ("acceleration", "braking_distance", "max_speed", "odometry", "ride")


@pytest.mark.parametrize("argument", ["vary", "unknown"])
@pytest.mark.parametrize("name", MEASURES)
def test_draws_do_not_override_fields_of_models(name: str, argument: str) -> None:
    models = {"wet": {"terrain.friction": 0.3}, "dry": {"terrain.friction": 0.9}}
    drawn: Any = {argument: {"terrain.friction": c2d.uniform(0.5, 0.6)}}
    base = c2d.Scenario(ROBOT, c2d.terrains.flat(), duration=1.0)
    study: Any = getattr(c2d.studies, name)
    error = refused(lambda: study(base, models=models, repeats=1, progress=False, **drawn))
    assert error.path == f"{argument}['terrain.friction']"


def test_an_approach_that_models_set_is_not_drawn() -> None:
    models = {str(each): {"start.approach": each} for each in (0.1, 0.3)}
    base = c2d.Scenario(ROBOT, c2d.terrains.step(0.05), duration=1.0)
    found = c2d.studies.ride(base, models=models, repeats=2, progress=False)
    assert "drawn_approach" not in found
    assert "drawn_speed" in found


STEP = c2d.Scenario(ROBOT, c2d.terrains.step(0.05))
GROUNDS = {"low": c2d.terrains.step(0.03), "high": c2d.terrains.step(0.3)}
OF_HEIGHT: dict[str, Callable[[Any], Any]] = {
    "critical_value": lambda models: c2d.studies.critical_value(
        STEP, "terrain.height", (0.03, 0.1), models=models
    ),
    "jam_chart": lambda models: c2d.studies.jam_chart(STEP, models=models, values=[0.05]),
    "max_obstacle": lambda models: c2d.studies.max_obstacle(STEP, models=models),
    "seizure_map": lambda models: c2d.studies.seizure_map(
        STEP, ("terrain.friction", [0.3, 0.6]), ("terrain.height", [0.1, 0.2]), models=models
    ),
}


@pytest.mark.parametrize("name", OF_HEIGHT)
def test_a_model_does_not_set_the_field_of_the_study(name: str) -> None:
    error = refused(lambda: OF_HEIGHT[name]({"as it is": {}, "low": {"terrain.height": 0.03}}))
    assert error.path == "models['low']"
    assert error.rule == "must not have terrain.height, which the study sets"


def test_a_model_does_not_replace_the_terrains_that_are_asked_for() -> None:
    model = {"on another": {"terrain": c2d.terrains.step(0.05)}}
    error = refused(lambda: c2d.studies.success_rate(STEP, terrains=GROUNDS, models=model))
    assert error.path == "models['on another']"
    error = refused(lambda: c2d.studies.search(STEP, model, terrains=GROUNDS))
    assert error.path == "space['on another']"


SCHEDULED = c2d.Scenario(
    ROBOT, c2d.terrains.step(0.05), drive=c2d.Drive(schedule=((0.0, 0.2),)), duration=0.1
)


@pytest.mark.parametrize(
    "study",
    [
        lambda: c2d.studies.critical_value(SCHEDULED, "drive.speed", (0.1, 0.3)),
        lambda: c2d.studies.seizure_map(
            SCHEDULED, ("drive.speed", [0.1, 0.3]), ("terrain.height", [0.03, 0.05])
        ),
        lambda: c2d.studies.success_rate(SCHEDULED, vary={"drive.speed": c2d.uniform(0.1, 0.3)}),
        lambda: c2d.studies.sensitivity(SCHEDULED, unknown={"drive.speed": c2d.uniform(0.1, 0.3)}),
    ],
)
def test_a_speed_that_a_schedule_replaces_is_not_studied(study: Callable[[], Any]) -> None:
    error = refused(study)
    assert error.path == "drive.speed"
    assert error.rule.endswith("drawn where drive.schedule begins at 0 s and sets it")


def test_a_speed_is_drawn_where_a_model_has_no_schedule() -> None:
    drawn: Any = {"vary": {"drive.speed": c2d.uniform(0.1, 0.3)}}
    models: Any = {"no schedule": {"drive.schedule": None}}
    few: Any = {"until": c2d.Until(max_runs=10), "progress": False}
    found = c2d.studies.success_rate(SCHEDULED, models=models, **drawn, **few)
    speeds = found["drawn_speed"].values.ravel()
    assert len(set(speeds[np.isfinite(speeds)].tolist())) == 10
