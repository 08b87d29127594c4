"""Unknowns are sampled in an outer loop, and give a band of rates."""

import json
import warnings
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import crawler2d as c2d
from crawler2d.variation.distributions import Ranges
from tests.kept import refusing
from tests.sweeps.small import BASE, BRIEF, SAID, quiet, refusal

PRESETS: dict[str, Callable[[], c2d.Robot]] = {
    "engineer": c2d.robots.engineer,
    "absolem": c2d.robots.absolem,
    "marv": c2d.robots.marv,
    "gz_tracked_vehicle": c2d.robots.gz_tracked_vehicle,
}
FRICTION = {"terrain.friction": c2d.uniform(0.5, 1.0)}


@pytest.fixture(scope="module")
def found() -> xr.Dataset:
    """A line of five on a step that it clears with some frictions."""
    base = BASE.replace({"robot.track": c2d.LineOfWheels(5), "duration": 8.0})
    heights = {"terrain.height": [0.02, 0.075]}
    return quiet(base, heights, unknown=FRICTION, samples=8, repeats=5, seed=3)


def test_every_sample_is_a_world_in_which_all_repeats_of_all_cells_run(found: xr.Dataset) -> None:
    assert found["outcome"].dims == ("height", "sample", "repeat")
    frictions = found["unknown_friction"].values
    assert (frictions == frictions[:1, :, :1]).all()
    assert len(set(frictions[0, :, 0].tolist())) == 8
    drawn = np.array([json.loads(t)["terrain"]["friction"] for t in found["scenario"].values.flat])
    own = frictions.ravel()
    assert (np.abs(drawn / own - 1.0) <= 0.02 + 1e-12).all()  # patches of that floor
    assert found["drawn_friction"].values.ravel().tolist() == drawn.tolist()


def test_a_sample_depends_on_seed_and_path_alone(found: xr.Dataset) -> None:
    more = {**FRICTION, "robot.mass": c2d.scaled(0.9, 1.1)}
    other = quiet(BRIEF, {}, unknown=more, samples=20, repeats=1, seed=3)
    own = found["unknown_friction"].values[0, :, 0]
    assert other["unknown_friction"].values[:8, 0].tolist() == own.tolist()


def test_every_run_of_every_sample_has_draws_of_its_own_and_all_cells_share_them(
    found: xr.Dataset,
) -> None:
    drawn = found["drawn_approach"].values
    assert len(set(drawn[0].ravel().tolist())) == 8 * 5
    assert (drawn == drawn[:1]).all()
    field = BRIEF.replace({"terrain": c2d.terrains.random_stepfield(0), "duration": 0.0})
    vary = c2d.variability.of_field()
    models = {"robot.track": {"belt": c2d.BeltTrack(), "line": c2d.LineOfWheels(5)}}
    table = quiet(field, models, vary=vary, unknown=FRICTION, samples=10, repeats=30)
    seeds = table["drawn_terrain_seed"].values
    assert len(set(seeds[0].ravel().tolist())) == 300
    assert (seeds == seeds[:1]).all()


def test_rates_are_a_band_and_never_averaged(found: xr.Dataset) -> None:
    rates = c2d.rate(found)
    assert rates["rate"].dims == ("height", "sample")
    assert (rates["count"] == 5).all()
    low, middle, high = (
        rates[name].sel(height=0.075) for name in ("band_low", "band_median", "band_high")
    )
    own = rates["rate"].sel(height=0.075).values
    assert (low.item(), middle.item(), high.item()) == tuple(np.quantile(own, [0.05, 0.5, 0.95]))
    assert low.item() < 0.3
    assert high.item() > 0.7
    assert "start.approach: Shifted" in rates.attrs["varied"]
    assert rates.attrs["unknown"] == "terrain.friction: Uniform(low=0.5, high=1.0)"


def test_few_distinct_poses_are_warned_of_unless_something_was_unknown(found: xr.Dataset) -> None:
    flat = quiet(BRIEF, {}, repeats=10, vary={"start.track_phase": c2d.uniform(0.0, 1e-6)})
    with pytest.warns(c2d.ScenarioWarning, match="4 or fewer in 1 of 1 cells"):
        rates = c2d.rate(flat)
    assert rates["distinct"].item() == 1
    with pytest.warns(c2d.ScenarioWarning, match="nothing varied"):
        c2d.rate(quiet(BRIEF, {}, repeats=10, vary={}))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        c2d.rate(quiet(BRIEF, {}, repeats=9, vary={}))
        c2d.rate(found)


def test_a_world_that_breaks_a_rule_is_refused_before_anything_runs() -> None:
    unknown = {"robot.mass": c2d.uniform(-1.0, -0.5)}
    error = refusal(BRIEF, {}, unknown=unknown, samples=2)
    assert error.path == "cell[sample=0].robot.mass"
    table = quiet(BRIEF, {}, unknown=unknown, samples=2, on_error="record")
    assert (table["outcome"] == "refused").all()


def test_variability_does_not_replace_unknowns() -> None:
    vary = {"terrain.friction": c2d.uniform(0.5, 1.0)}
    assert refusal(BRIEF, {}, unknown=FRICTION, vary=vary).path == "vary['terrain.friction']"
    over = {"terrain.friction": [0.5]}
    assert refusal(BRIEF, over, unknown=FRICTION).path == "unknown['terrain.friction']"
    assert refusal(BRIEF, {}, unknown=FRICTION, samples=0).path == "samples"
    for given in (["terrain.friction"], [], 0, False, ""):
        assert refusal(BRIEF, {}, unknown=given).path == "unknown"


@pytest.mark.parametrize("name", PRESETS)
def test_every_preset_lists_its_unknowns_with_reasons(name: str) -> None:
    robot = PRESETS[name]()
    assert robot.name == name
    ranges = c2d.unknowns.of_robot(robot)
    assert set(ranges.sources) == set(ranges)
    assert "robot.center_of_mass[0]" in ranges
    base = c2d.Scenario(robot, c2d.terrains.step(0.02), duration=0.0)
    both = ranges | c2d.unknowns.of_ground()
    table = quiet(base, {}, unknown=both, samples=20, repeats=1)  # every world is legal
    moved = table["unknown_belly_1"].values[:, 0]
    assert np.ptp(moved) > 0.005


def test_the_belly_moves_as_a_whole() -> None:
    robot = c2d.robots.engineer()
    assert robot.belly is not None
    unknown = {"robot.belly[*][1]": c2d.shifted(-0.01, 0.01)}
    base = c2d.Scenario(robot, c2d.terrains.step(0.02), duration=0.0)
    table = quiet(base, {}, unknown=unknown, samples=3, repeats=1)
    for text, lowest in zip(
        table["scenario"].values[:, 0], table["unknown_belly_1"].values[:, 0], strict=True
    ):
        belly = np.array(json.loads(text)["robot"]["belly"])
        shift = belly - np.array(robot.belly)
        assert shift[:, 0].tolist() == [0.0] * len(belly)
        assert np.allclose(shift[:, 1], lowest - robot.belly[0][1])


def test_a_robot_without_belly_and_one_of_ones_own_have_ranges_too() -> None:
    own = c2d.Robot.simple(10.0, axle_distance=0.3, radius=0.05)
    assert "robot.belly[*][1]" not in c2d.unknowns.of_robot(own)
    armless = c2d.unknowns.of_robot(c2d.robots.marv(flippers=None))
    assert not [path for path in armless if path.startswith("robot.flippers")]
    quiet(
        c2d.Scenario(own, c2d.terrains.step(0.02), duration=0.0),
        {},
        unknown=c2d.unknowns.of_robot(own),
        samples=3,
        repeats=1,
    )
    with refusing(SAID, "must be a Robot"):
        c2d.unknowns.of_robot("engineer")  # type: ignore[arg-type]


def test_rotors_that_a_robot_does_not_state_follow_from_its_torque_and_speed() -> None:
    """As run-up times of 0.016 to 0.1 s, log-uniform."""
    rotor, of_arm = "robot.drivetrain.rotor_inertia", "robot.flippers.rotor_inertia"
    own = c2d.Robot.simple(10.0, axle_distance=0.3, radius=0.05, max_speed=0.5)
    belt_radius = own.outline.rear_radius - own.outline.grouser_height
    ends = np.array([0.0, 1.0])
    found = c2d.unknowns.of_robot(own)[rotor].values(ends, 0.0)
    times = found / own.drivetrain.max_torque * own.drivetrain.max_speed / belt_radius
    assert times == pytest.approx([0.016, 0.1])
    arms = c2d.Flippers(
        length=0.2, root_radius=0.05, tip_radius=0.03, mass=0.5, rate_limit=2.0, torque_limit=10.0
    )
    found = c2d.unknowns.of_robot(own.with_flippers(arms))[of_arm].values(ends, 0.0)
    assert found == pytest.approx([0.016 * 10.0 / 2.0, 0.1 * 10.0 / 2.0])
    stated = replace(own, drivetrain=replace(own.drivetrain, rotor_inertia=0.01))
    coasting = replace(own, drivetrain=replace(own.drivetrain, max_torque=0.0))
    for robot in (stated, coasting):
        assert rotor not in c2d.unknowns.of_robot(robot)
    with refusing(SAID, "max_speed"):
        c2d.unknowns.of_robot(replace(own, drivetrain=replace(own.drivetrain, max_speed=0.0)))


@pytest.mark.parametrize("name", PRESETS)
def test_a_preset_without_rotors_has_none_to_draw(name: str) -> None:
    ranges = c2d.unknowns.of_robot(PRESETS[name]().without_rotors())
    assert not [path for path in ranges if "rotor" in path]
    assert "robot.drivetrain.max_torque" in ranges


@pytest.mark.parametrize("name", PRESETS)
def test_a_presets_rotors_are_in_the_middle_of_their_ranges(name: str) -> None:
    """The geometric mean, to two digits: half of the last one is at most 5 %."""
    robot = PRESETS[name]()
    assert robot.flippers is not None
    ranges = c2d.unknowns.of_robot(robot)
    own = {
        "robot.drivetrain.rotor_inertia": robot.drivetrain.rotor_inertia,
        "robot.flippers.rotor_inertia": robot.flippers.rotor_inertia,
    }
    assert {path for path, inertia in own.items() if inertia > 0.0} == set(ranges) & set(own)
    for path in set(ranges) & set(own):
        (middle,) = ranges[path].values(np.array([0.5]), 0.0)
        assert own[path] == pytest.approx(middle, rel=0.05)


def test_joined_ranges_keep_their_sources() -> None:
    both = c2d.variability.of_start() | {"start.approach": c2d.uniform(0.0, 0.1)}
    assert isinstance(both, Ranges)
    assert list(both) == ["start.approach", "start.track_phase"]
    assert list(both.sources) == ["start.track_phase"]
    assert both.optional == {"start.track_phase"}
    other = {"gravity": c2d.uniform(9.0, 10.0)} | c2d.variability.of_contact()
    assert list(other) == ["gravity", "drive.speed", "terrain.friction"]
    assert "estimate" in repr(other)
