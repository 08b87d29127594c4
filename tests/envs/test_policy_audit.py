"""The audit of a policy: its runs and its summary."""

import math
from typing import Any

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray

import crawler2d as c2d
from crawler2d.envs import FlipperEnv, FlipperVectorEnv, audit_policy
from crawler2d.envs.policy_audit import _gain, _lost
from crawler2d.pictures.policies import plot_policy
from crawler2d.sweeps.statistics import newcombe_paired
from tests.shared import refused

FLIPPERS = c2d.robots.absolem().flippers
START = FLIPPERS.angle if FLIPPERS else 0.0
MODELS = {"belt": c2d.BeltTrack(), "skids": c2d.ForceTrack()}
STEPS = {height: c2d.terrains.step(height) for height in (0.1, 0.2)}
VARIED = c2d.variability.of_start()


def holding(seen: NDArray[np.float32]) -> NDArray[np.float64]:
    """Drive on with the flippers at their initial angles."""
    return np.tile([1.0, START / np.pi, START / np.pi], (len(seen), 1))


def climbing(seen: NDArray[np.float32]) -> NDArray[np.float64]:
    """Keep the front flippers level and push with the rear ones as the nose rises."""
    pitch, front, rear = seen[:, 0], seen[:, 3], seen[:, 4]
    rates = [0.4 - pitch - front, 0.3 - 2.0 * pitch - rear]
    return np.stack([np.ones(len(seen)), *(np.clip(3.0 * rate, -1.0, 1.0) for rate in rates)], 1)


def audited(policy: Any, env: Any = None, **options: Any) -> Any:
    given: dict[str, Any] = {"models": MODELS, "obstacles": STEPS, "repeats": 4, "vary": VARIED}
    return audit_policy(policy, env or FlipperEnv(), progress=False, **(given | options))


def test_a_policy_that_does_what_a_gait_does_gains_nothing_and_loses_nothing() -> None:
    env = FlipperVectorEnv(1, flipper_command="angle")
    found = audited(holding, env, baseline=c2d.Hold(START))
    outcome = found.outcome
    assert (outcome.sel(driver="policy") == outcome.sel(driver="baseline")).all()
    assert (found.gain == 0.0).all()
    assert (found.lost == 0.0).all()
    assert (found.gain_low < 0.0).all()
    assert found.attrs["summary"].startswith("no gain over the baseline on belt")


def test_both_drivers_have_the_duration_of_their_obstacle() -> None:
    obstacles = {label: {"duration": float(label), "terrain": STEPS[0.1]} for label in (1, 2)}
    env = FlipperVectorEnv(1, flipper_command="angle", dt=0.4)
    found = audited(holding, env, obstacles=obstacles, baseline=c2d.Hold(START), repeats=1)
    assert (found.outcome == "timed_out").all()
    for duration in (1, 2):
        assert found.time.sel(obstacle=duration).values == pytest.approx(duration)


@pytest.fixture(scope="module")
def climbed() -> Any:
    return audited(climbing)


def test_its_runs_are_those_of_the_environment(climbed: Any) -> None:
    cell = climbed.sel(driver="policy", model="skids", obstacle=0.2)
    for repeat in range(4):
        text = str(cell.scenario.isel(repeat=repeat).item())
        scenario = c2d.Scenario.from_json(text)
        env = FlipperEnv(scenario, randomize={})
        seen, _ = env.reset()
        done = False
        while not done:
            seen, _, terminated, truncated, info = env.step(climbing(seen[None])[0])
            done = terminated or truncated
        own = cell.isel(repeat=repeat)
        assert env.state.position[0, 0] == pytest.approx(own.final_x.item(), abs=1e-9)
        if info["outcome"] in ("cleared", "tipped_over"):
            assert info["outcome"] == own.outcome.item()


def test_it_says_where_gains_are_lost() -> None:
    weak, step = c2d.Hold(1.2), {"step": c2d.terrains.step(0.2)}
    models = {"belt": c2d.BeltTrack(), "two wheels": c2d.LineOfWheels(2)}
    found = audited(climbing, baseline=weak, models=models, obstacles=step)
    belt, wheels = (found.sel(model=model, obstacle="step") for model in models)
    for cell, rates in ((belt, [1.0, 0.0]), (wheels, [0.0, 0.0])):
        assert cell.rate.values.tolist() == rates
        assert cell.gain.item() == rates[0]
        assert cell.lost.item() == 1.0 - rates[0]
        assert (cell.lost_low.item() > 0.0) == (cell is wheels)
    summary = "step: clears 100% on belt, the baseline 0%; some of this gain is lost on two wheels"
    assert found.attrs["summary"] == summary
    assert wheels.ending.item() == "seized, straddled: 4 of 4"
    ax = found.plot()
    drawn = " ".join(text.get_text() for text in ax.texts)
    assert "100% (0%)" in drawn
    assert len(ax.patches) == 1
    with pytest.raises(c2d.ScenarioError, match="must have models, obstacles and both"):
        found.sel(model="belt").plot()


def test_where_nothing_is_gained_the_picture_shows_nothing_lost() -> None:
    cell = ("driver", "model", "obstacle")
    columns: Any = {
        "rate": (cell, [[[0.5], [0.0]], [[0.5], [1.0]]]),
        "gain": (cell[1:], [[0.0], [-1.0]]),
        "gain_low": (cell[1:], [[-0.2], [-1.0]]),
        "lost_low": (cell[1:], [[0.0], [0.6]]),
        "ending": (cell[1:], [[""], ["seized: 10 of 10"]]),
    }
    coords = {"driver": ["policy", "baseline"], "model": ["a", "b"], "obstacle": ["step"]}
    data = xr.Dataset(columns, {**coords, "repeat": range(10)})
    assert not plot_policy(data, None).patches
    assert len(plot_policy(data.assign(gain_low=data["gain_low"] + 1.0), None).patches) == 1


def test_a_picture_of_parts_has_the_first_model_and_both_drivers(climbed: Any) -> None:
    found = climbed
    first, other = MODELS
    assert found.attrs["first_model"] == first
    assert f"gain on {first}" in found.sel(model=[first]).plot().get_title(loc="left")
    parts: list[Any] = [{"model": [other, first]}, {"model": [other]}]
    for part in parts:
        assert refused(lambda part=part: found.sel(part).plot()).rule.startswith(
            f"must begin with {first}, on which the policy was trained"
        )
    for part in ({"driver": ["policy"]}, {"driver": "policy"}, {"obstacle": 0.2}):
        assert "both drivers" in refused(lambda part=part: found.sel(part).plot()).rule


def test_a_run_without_an_outcome_is_left_out_of_the_gain_with_its_pair() -> None:
    ours = np.array(["cleared", "cleared", "diverged", "stalled"], dtype=object)
    theirs = np.array(["seized", "cleared", "cleared", "diverged"], dtype=object)
    assert _gain(ours, theirs) == newcombe_paired(both=1, first=1, second=0, neither=0)
    assert np.isnan(_gain(ours[2:], theirs[2:])).all()


def test_a_lost_gain_has_the_interval_of_two_independent_differences() -> None:
    first, other = (0.8, 0.6, 0.9), (0.3, 0.1, 0.6)
    found = _lost(first, other)
    assert found.rate == pytest.approx(0.5)
    assert found.low == pytest.approx(0.5 - math.hypot(0.2, 0.3))
    assert found.high == pytest.approx(0.5 + math.hypot(0.1, 0.2))


def test_wrong_arguments_are_refused_before_anything_runs() -> None:
    wrong: list[tuple[dict[str, Any], str]] = [
        ({"policy": 1.0}, "policy"),
        ({"env": "crawler2d/FlipperClimb-v0"}, "env"),
        ({"baseline": 0.8}, "baseline"),
        ({"models": {"belt": "belt"}}, "models['belt']"),
        ({"obstacles": {}}, "obstacles"),
        ({"obstacles": {"step": 0.1}}, "obstacles['step']"),
        ({"repeats": 0}, "repeats"),
        ({"vary": {"terrain.friction": 0.5}}, "vary['terrain.friction']"),
    ]
    for options, path in wrong:
        given = {"policy": climbing, "env": FlipperEnv()} | options
        with pytest.raises(c2d.ScenarioError) as failure:
            audited(given.pop("policy"), given.pop("env"), **given)
        assert failure.value.path == path


def test_a_model_with_flippers_elsewhere_is_refused() -> None:
    robots = {"as it is": {}, "without": c2d.robots.absolem(flippers=None)}
    with pytest.raises(c2d.ScenarioError, match=r"models\['without'\] must have flippers"):
        audited(climbing, models=robots)


def test_a_policy_of_the_wrong_shape_is_refused() -> None:
    with pytest.raises(c2d.ScenarioError, match="action"):
        audited(lambda seen: seen)


def test_rows_of_episodes_that_have_ended_do_not_matter(climbed: Any) -> None:
    def undefined_when_over(seen: Any) -> Any:
        # The observation of a finished episode does not change any more.
        over = (seen == last[-1]).all(axis=1) if last else np.zeros(len(seen), bool)
        last.append(seen.copy())
        return np.where(over[:, None], np.nan, climbing(seen))

    last: list[Any] = []
    assert audited(undefined_when_over).rate.identical(climbed.rate)
    assert np.isnan(undefined_when_over(last[-1])).any()
