"""Copies of a robot with another size or mass are accepted, and move like the original."""

import copy
import json
import math
import warnings
from functools import cache
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.common.units import unit_of
from crawler2d.parameters.fields import to_dict
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.track import Track

POWERS = {  # of length, mass and time
    "1": (0, 0, 0),
    "rad": (0, 0, 0),
    "m": (1, 0, 0),
    "s": (0, 0, 1),
    "kg": (0, 1, 0),
    "rad/s": (0, 0, -1),
    "Hz": (0, 0, -1),
    "m/s": (1, 0, -1),
    "m/s^2": (1, 0, -2),
    "N": (1, 1, -2),
    "N m": (2, 1, -2),
    "N/m": (0, 1, -2),
    "N s/m": (0, 1, -1),
    "kg m^2": (2, 1, 0),
}
BARE = c2d.robots.engineer(flippers=None).without_rotors()
GEARS = c2d.LineOfWheels(4, wheel_radius=0.0608, wheel=c2d.GearWheel(grouser_count=12))
TRACKS: dict[str, Track] = {
    "belt": c2d.BeltTrack(),
    "belt with grousers": c2d.GrouserBeltTrack(),
    "wheels": c2d.LineOfWheels(4, wheel_radius=0.0608),
    "gears": GEARS,
    "small wheels": c2d.CircumferentialWheels(24),
    "chain": c2d.SegmentalTrack(),
    "chain on a sprocket": c2d.SegmentalTrack(mechanism="sprocket"),
    "force": c2d.ForceTrack(),
}
STEPS = {
    (name, height): Scenario(BARE.with_track(track), c2d.terrains.step(height))
    for name, track in TRACKS.items()
    for height in (0.05, 0.1)
}
CLIMB = Scenario(c2d.robots.engineer(), c2d.terrains.step(0.2), drive=c2d.Drive(gait=c2d.Climb()))
CASES: dict[tuple[str, Any], Scenario] = {
    **STEPS,
    ("wheels", "knife edge"): Scenario(
        BARE.with_track(TRACKS["wheels"]), c2d.terrains.knife_edge(0.04)
    ),
    ("flippers", 0.2): CLIMB,
}
# Chains take longer than all others together; by default they have one step.
LONG = [case for case in CASES if case[0].startswith("chain") and case[1] > 0.05]
ids = pytest.mark.parametrize(
    "case",
    [
        pytest.param(
            case, id=", ".join(map(str, case)), marks=pytest.mark.soak if case in LONG else ()
        )
        for case in CASES
    ],
)
# A warning says that nobody builds such robots.
any_mass = pytest.mark.filterwarnings("ignore:robot.mass:crawler2d.ScenarioWarning")


def scaled(scenario: Scenario, length: float, mass: float, time: float) -> Scenario:
    """Multiply every number of a scenario with the factors of its unit."""

    def of(value: Any, path: str) -> Any:
        if isinstance(value, dict):
            return {k: of(v, f"{path}.{k}".removeprefix(".")) for k, v in value.items()}
        if isinstance(value, list):
            return [of(v, f"{path}[{i}]") for i, v in enumerate(value)]
        unit = unit_of(path)
        if unit is None or isinstance(value, (bool, str)) or value is None:
            return value
        of_length, of_mass, of_time = POWERS[unit]
        factor = length**of_length * mass**of_mass * time**of_time
        return value if factor == 1.0 else value * factor

    return Scenario.from_json(json.dumps(of(to_dict(scenario), "")))


@cache
def original(case: tuple[str, Any]) -> c2d.Run:
    """The original run of a case, for comparison in several tests."""
    return c2d.simulate(CASES[case])


@pytest.mark.parametrize("size", [10.0, 1.0 / 16.0])
@ids
def test_a_copy_of_another_size_runs_and_ends_as_the_original(
    case: tuple[str, Any], size: float
) -> None:
    """Froude's law: if speeds and times grow with the root of the size, gravity stays the same."""
    time = math.sqrt(size)
    with warnings.catch_warnings():
        warnings.simplefilter("error", c2d.ScenarioWarning)
        run = original(case)
        other = c2d.simulate(scaled(CASES[case], size, size**3, time))
    assert other.outcome == run.outcome
    metrics = {name: value for name, value in other.metrics.items() if name != "time_to_clear"}
    assert np.isfinite(list(metrics.values())).all()
    # Lengths and times of the solver itself, such as those of its shortest step, are not scaled.
    assert other.metrics["time"] / time == pytest.approx(run.metrics["time"], rel=0.05)
    # Which grouser grips the edge is chance: a robot may be one grouser farther or less far.
    plain = case[0] in ("belt", "wheels", "small wheels", "force")
    apart = 0.03 if plain else BARE.outline.grouser_pitch
    assert other.metrics["final_x"] / size == pytest.approx(run.metrics["final_x"], abs=apart)


@any_mass
@pytest.mark.parametrize("factor", [2.0**35, 2.0**-37], ids=["near the most", "near the least"])
@ids
def test_robots_of_any_mass_move_alike_to_the_last_bit(
    case: tuple[str, Any], factor: float
) -> None:
    """Limits of mass come from float64, and no digits are lost near them."""
    run = original(case)
    heavy = scaled(CASES[case], 1.0, factor, 1.0)
    other = c2d.simulate(heavy)
    assert other.outcome == run.outcome
    assert np.array_equal(other.time, run.time)
    assert np.array_equal(other.position, run.position)
    assert np.array_equal(other.drive_force, factor * run.drive_force)


@any_mass
@pytest.mark.parametrize("factor", [2.0**35, 2.0**-37])
def test_stops_at_any_mass_have_the_same_diagnosis_and_trials(factor: float) -> None:
    base = STEPS["wheels", 0.1]
    run, other = c2d.simulate(base), c2d.simulate(scaled(base, 1.0, factor, 1.0))
    assert [t.freed for t in other.trials()] == [t.freed for t in run.trials()]
    held, moved = run.escape_force()
    assert other.escape_force() == pytest.approx((factor * held, factor * moved), rel=1e-12)
    sim = c2d.Simulation(other.scenario)
    sim.advance(2.0)
    twin = copy.deepcopy(sim)  # by a snapshot, whose numbers must be plausible
    for each in (sim, twin):
        each.command(push=factor)
        each.advance(0.5)
    assert np.array_equal(sim.state().position, twin.state().position)


@pytest.mark.parametrize("name", ["belt", "wheels", "force"])
def test_tracks_as_light_as_may_be_move_as_others_do(name: str) -> None:
    heavy = STEPS[name, 0.1].replace({"robot.track_mass": 1e-3 * BARE.mass})
    light = heavy.replace({"robot.track_mass": 1.01e-5 * BARE.mass})
    runs = c2d.simulate(heavy), c2d.simulate(light)
    assert runs[0].outcome == runs[1].outcome
    assert runs[1].metrics["unresolved_solves"] == 0
    final = [run.metrics["final_x"] for run in runs]
    assert final[0] == pytest.approx(final[1], abs=1e-3)


def test_parts_too_light_for_the_robot_are_refused() -> None:
    for path, robot in (("track_mass", BARE), ("flippers.mass", CLIMB.robot)):
        scenario = Scenario(robot, c2d.terrains.flat())
        with pytest.raises(c2d.ScenarioError, match=r"hundred-thousandth of robot\.mass") as caught:
            scenario.replace({f"robot.{path}": 0.99e-5 * robot.mass}).validate()
        assert caught.value.path == f"robot.{path}"
