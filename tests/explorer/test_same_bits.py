"""The core in a browser gives the same results, bit by bit."""

import base64
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from crawler2d.pictures.page.recording import recording
from tests.explorer.conftest import ask
from tests.fuzz.drawn_robots import Draw
from tests.fuzz.drawn_scenes import drawn_scenario
from tests.shared import ROBOT, VARIANTS

FILES = sorted((Path(__file__).parents[1] / "scenarios").glob("*.json"))
DRAWN = 20
WHEELS = c2d.LineOfWheels(4, wheel_radius=0.0608)
SCENARIOS = {
    **{path.stem: Scenario.from_json(path.read_text(encoding="utf-8")) for path in FILES},
    **VARIANTS,
    **{f"drawn {seed}": drawn_scenario(Draw(seed)) for seed in range(DRAWN)},
    "the README's": Scenario(ROBOT.with_track(WHEELS), c2d.terrains.step(0.075)),
}
INTERVAL = 0.02
pytestmark = pytest.mark.filterwarnings("ignore::crawler2d.ScenarioWarning")


def test_there_are_enough_scenarios_of_every_track() -> None:
    tracks = {scenario.robot.track.kind for scenario in SCENARIOS.values()}
    assert len(SCENARIOS) > 50
    assert tracks == {type(each.robot.track).kind for each in VARIANTS.values()}


@pytest.mark.parametrize("name", SCENARIOS)
def test_a_run_has_the_same_bits(asked: Page, name: str) -> None:
    scenario = SCENARIOS[name]
    answer = ask(asked, scenario.to_json(), ["torque x 2", "friction x 2"])
    broken = None
    try:
        run = c2d.simulate(scenario, record="summary", trials="auto")
    except c2d.ScenarioError as error:
        broken = (error.path, error.value, error.rule)
    told = answer.get("error")
    assert broken == (told and tuple(told[name] for name in ("path", "value", "rule")))
    if broken:
        return
    # JSON has no infinite numbers.
    metrics = {each: v if math.isfinite(v) else None for each, v in run.metrics.items()}
    assert answer["metrics"] == metrics
    assert answer["outcome"] == run.outcome
    assert answer["sentence"] == str(run.diagnosis or "")
    untried = ask(asked, scenario.to_json())
    assert untried["metrics"] == metrics
    if run.diagnosis is not None:
        assert untried["diagnosis"]["trials"] == []
        assert untried["outcome"] == run.diagnosis.symptom


def test_the_sentence_that_is_compared_has_trials() -> None:
    run = c2d.simulate(SCENARIOS["the README's"])
    assert str(run.diagnosis).count(";") > 3


@pytest.mark.parametrize("name", VARIANTS)
def test_the_page_draws_what_a_replay_draws(asked: Page, name: str) -> None:
    scenario = VARIANTS[name].replace({"duration": 3.0})
    shown = ask(asked, scenario.to_json(), None, INTERVAL)["drawing"]
    run = c2d.simulate(scenario, sample_interval=INTERVAL)
    drawn = recording(run)
    compare("", plain(shown), plain(drawn), rounding(drawn["contacts"]))


def plain(drawing: Any) -> Any:
    """Replace references to columns and outlines by their values."""
    robot = drawing["robot"]
    columns, outlines = (
        [unpacked(each) for each in robot.pop(name)] for name in ("columns", "outlines")
    )
    count = drawing["frames"]["count"]

    def resolved(value: Any, name: str = "") -> Any:
        if name in ("outlines", "grousers"):
            return [outlines[index] for index in value]
        if isinstance(value, dict) and "column" in value:
            return columns[value["column"]]
        if isinstance(value, dict) and "data" in value:
            return unpacked(value)
        if isinstance(value, dict):
            return {key: resolved(each, key) for key, each in value.items()}
        if isinstance(value, list) and value and isinstance(value[0], dict):
            return [resolved(each) for each in value]
        moves = name in ("x", "y", "angle", "travel") and isinstance(value, float | int)
        return np.full(count, value) if moves else value

    robot["mass_center"] = [resolved(each, "x") for each in robot["mass_center"]]
    for name in ("samples", "every", "first", "ghosts"):
        drawing.pop(name, None)
    return resolved(drawing)


def unpacked(item: Any) -> np.ndarray[Any, Any]:
    """Reverse `pack`; the explorer's columns are lists."""
    if isinstance(item, list):
        return np.array(item)
    kind = {8: "<u1", 16: "<u2", 32: "<f4"}[item["bits"]]
    counts = np.frombuffer(base64.b64decode(item["data"]), kind).astype(float)
    return counts if item["bits"] == 32 else item["start"] + item["step"] * counts


def compare(path: str, shown: Any, expected: Any, within: Mapping[str, float]) -> None:
    """Compare two drawings: names exactly, numbers within the rounding of a replay."""
    if isinstance(expected, dict):
        assert shown.keys() == expected.keys(), path
        for name in expected:
            compare(f"{path}.{name}", shown[name], expected[name], within)
    elif isinstance(expected, list) and expected and not isinstance(expected[0], float | int):
        assert len(shown) == len(expected), path
        for i, (one, other) in enumerate(zip(shown, expected, strict=True)):
            compare(f"{path}[{i}]", one, other, within)
    elif isinstance(expected, str | bool | None):
        assert shown == expected, path
    else:
        most = within.get(path.rpartition(".")[2].partition("[")[0], 2e-4)
        np.testing.assert_allclose(shown, expected, rtol=1e-6, atol=most, err_msg=path)


def rounding(contacts: Any) -> dict[str, float]:
    """Return the rounding of a replay, where it is more than 0.2 mm."""
    force, speed = (1e-2 * contacts[name] for name in ("usual_force", "usual_speed"))
    forces = dict.fromkeys(("normal_force", "friction_force"), force)
    # The rim of the smallest wheel, 15 mm, moves by 0.1 mm as it turns by this.
    return {**forces, "surface_speed": speed, "counts": 0.5, "angle": 7e-3, "normal": 2e-4}
