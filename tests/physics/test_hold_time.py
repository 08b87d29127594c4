"""The time after which a stop counts: success against the hold time."""

import itertools
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario

HOLDS = (1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 60.0)  # [s]
DURATION = 80.0  # [s]

GEAR = c2d.GearWheel()
MODELS: dict[str, Any] = {
    "line of 3": c2d.LineOfWheels(3),
    "line of 5": c2d.LineOfWheels(5),
    "24 all round": c2d.CircumferentialWheels(24),
    "line of 3 gears": c2d.LineOfWheels(3, wheel=GEAR),
    "line of 5 gears": c2d.LineOfWheels(5, wheel=GEAR),
    "24 gears all round": c2d.CircumferentialWheels(24, wheel=GEAR),
}
STEPS = (0.060, 0.075, 0.090, 0.100, 0.125)  # [m]
BARRIERS = (0.060, 0.080, 0.100)  # [m]


def scenarios(track: Any, repeats: int) -> list[Scenario]:
    """On the study's steps and barriers, with its small variations."""
    steps = [("step", height) for height in STEPS]
    barriers = [("barrier", height) for height in BARRIERS]
    drawn = []
    for (kind, height), repeat in itertools.product(steps + barriers, range(repeats)):
        u = np.random.default_rng([0, repeat]).random(4)
        friction = 0.9 * (0.98 + 0.04 * u[3])
        terrain: Any = c2d.terrains.step(height, friction=friction)
        if kind == "barrier":
            terrain = c2d.terrains.barrier(height, 0.1, friction=friction)
        drawn.append(
            Scenario(
                c2d.robots.engineer(flippers=None, track=track).without_rotors(),
                terrain,
                drive=c2d.Drive(speed=0.4 * (0.98 + 0.04 * u[2])),
                start=c2d.Start(approach=0.05 + 0.1 * u[0], track_phase=0.048 * u[1]),
                duration=DURATION,
            )
        )
    return drawn


def longest_stop(run: c2d.Run) -> float:
    """[s] Longest stop before the goal was reached."""
    stops = run.events["kind"] == "stop"
    lengths = np.asarray(run.events["end"] - run.events["start"])[stops]
    return float(lengths.max(initial=0.0))


@pytest.mark.parametrize(
    ("models", "repeats"),
    [
        # Those with 24 wheels take longest.
        pytest.param([name for name in MODELS if "line" in name], 1, id="once"),
        pytest.param(list(MODELS), 10, id="often", marks=pytest.mark.soak),
    ],
)
def test_rates_do_not_depend_on_the_hold_time_of_a_stop(
    models: list[str], repeats: int, say: Callable[[str], None]
) -> None:
    lines = ["held for [s]         " + "".join(f"{hold:6.0f}" for hold in HOLDS) + "   cleared"]
    moved, stood = [], []
    for name in models:
        runs = c2d.simulate_many(scenarios(MODELS[name], repeats), threads=2, record="summary")
        cleared = np.array([run.outcome is c2d.Outcome.CLEARED for run in runs])
        longest = np.array([longest_stop(run) for run in runs])
        rates = [float(np.mean(cleared & (longest <= hold))) for hold in HOLDS]
        lines.append(
            f"{name:21}" + "".join(f"{rate:6.2f}" for rate in rates) + f"   {cleared.sum()}"
        )
        late = sorted(longest[cleared & (longest > HOLDS[0])].round(1).tolist())
        if late:
            lines.append(f"{'':21}freed after {late}")
        assert cleared.any()
        stood.append(float(longest[~cleared].max(initial=0.0)))
        moved.append(rates[HOLDS.index(30.0)] - rates[HOLDS.index(10.0)])
    lines.append(f"from 10 s to 30 s at most {max(moved):.3f}")
    say("\n  ".join(lines))
    assert max(stood) > HOLDS[-1]  # so that stops are observed at all
    assert max(moved) <= 0.05
