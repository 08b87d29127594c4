"""Draws of repeats: the same for every cell, whatever else is drawn."""

import math
from typing import Any

import numpy as np
import pytest
from scipy import stats  # type: ignore[import-untyped]

import crawler2d as c2d
from crawler2d._core import PreparedScenario
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Lanes
from crawler2d.studies.campaign import scaled_draws
from crawler2d.sweeps.plan import Plan, Planner, plan_runs
from crawler2d.variation.distributions import (
    Levels,
    LogUniform,
    scaled,
    shifted,
    uniform,
    uniform_int,
)
from crawler2d.variation.draws import Variation, uniform_numbers
from tests.kept import refusing
from tests.shared import ROBOT, VARIANTS
from tests.sweeps.small import SAID, quiet

DEFAULT_PATHS = ["start.approach", "start.track_phase", "drive.speed", "terrain.friction"]


def planned(cell: Scenario, variation: Variation, repeats: int) -> Plan:
    (plan,) = plan_runs(cell, [], Planner(variation, Variation({}), seed=0), repeats=repeats)
    return plan


def drawn(cell: Scenario, *, base: Scenario | None = None, swept: tuple[str, ...] = ()) -> Any:
    """The default draws of 200 repeats, shape (200,) by path."""
    plan = planned(cell, Variation.read(base or cell, None, swept), 200)
    assert all(isinstance(each, PreparedScenario) for each in plan.checked)
    return plan.drawn


def value(distribution: Any, number: float, own: Any = None) -> float:
    """The value to which a number from 0 to 1 is mapped."""
    return float(distribution.values(np.array([number]), own)[0])


def draw(cell: Scenario, vary: Any, number: float = 0.5) -> dict[str, float]:
    """The values of one draw by path of a field."""
    variation = Variation.read(cell, vary, [])
    found = variation.draw(cell, {path: np.array([number]) for path in vary})
    return {path: float(values[0]) for path, values in found.values.items()}


def test_a_uniform_value_lies_between_its_bounds_whatever_the_scenario() -> None:
    assert value(uniform(0.05, 0.15), 0.0, own=7.0) == 0.05
    assert value(uniform(0.05, 0.15), 0.25) == pytest.approx(0.075)
    assert value(uniform(0.1, 0.1), 0.7) == 0.1


def test_a_scaled_value_is_a_share_of_the_scenarios_own() -> None:
    assert value(scaled(0.98, 1.02), 0.5, own=0.4) == pytest.approx(0.4)
    assert value(scaled(0.98, 1.02), 0.0, own=-0.4) == pytest.approx(-0.392)


def test_a_shifted_value_lies_about_the_scenarios_own() -> None:
    assert value(shifted(-0.04, 0.04), 0.25, own=0.1) == pytest.approx(0.08)
    assert value(shifted(-0.04, 0.04), 1.0, own=-1.0) == pytest.approx(-0.96)
    above = shifted(-0.04, 0.04, minimum=0.0)
    assert [value(above, n, own=0.01) for n in (0.0, 1.0)] == pytest.approx([0.0, 0.08])
    base = Scenario(ROBOT, c2d.terrains.step(0.05))
    share = shifted(-0.5, 0.5, unit="robot.outline.axle_distance").resolve(base)
    assert value(share, 1.0, own=0.0) == pytest.approx(0.5 * ROBOT.outline.axle_distance)


def test_a_frozen_distribution_of_scipy_gives_its_quantiles() -> None:
    base = Scenario(ROBOT, c2d.terrains.random_stepfield(0))
    vary = {"terrain.friction": stats.norm(0.8, 0.05), "terrain.seed": stats.randint(3, 5)}
    assert draw(base, vary) == {"terrain.friction": pytest.approx(0.8), "terrain.seed": 3.0}
    assert draw(base, vary, 0.9)["terrain.seed"] == 4.0
    text = Variation.read(base, vary, []).text
    assert text == "terrain.friction: norm(0.8, 0.05); terrain.seed: randint(3, 5)"
    with refusing(SAID, "uniform_int"):
        draw(base, {"terrain.seed": stats.norm(0.8, 0.05)})


def test_every_element_gets_the_same_shift() -> None:
    base = Scenario(ROBOT, c2d.terrains.step(0.05))
    moved = draw(base, {"robot.belly[*][1]": shifted(0.01, 0.01)})
    assert ROBOT.belly is not None
    assert list(moved.values()) == pytest.approx([y + 0.01 for _, y in ROBOT.belly])


def test_a_number_has_no_elements_to_draw() -> None:
    base = Scenario(ROBOT, c2d.terrains.step(0.05))
    with refusing(SAID, "must be a path of elements, got"):
        draw(base, {"terrain.height[*]": uniform(0.05, 0.06)})


def test_no_value_lies_beyond_the_upper_bound() -> None:
    almost_1 = math.nextafter(1.0, 0.0)
    for low, high in np.random.default_rng(0).uniform(-1.0, 1.0, (1000, 2)):
        distribution = uniform(min(low, high), max(low, high))
        assert distribution.low <= value(distribution, almost_1) <= distribution.high


def test_every_octave_of_log_uniform_has_the_same_share() -> None:
    octaves = LogUniform(0.25, 4.0)
    shares = [value(octaves, share, own=7.0) for share in (0.0, 0.25, 0.5, 0.75, 1.0)]
    assert shares == pytest.approx([0.25, 0.5, 1.0, 2.0, 4.0], rel=1e-15)
    for low, high in np.exp(np.random.default_rng(0).uniform(-9.0, 9.0, (1000, 2))):
        distribution = LogUniform(min(low, high), max(low, high))
        ends = value(distribution, 0.0), value(distribution, math.nextafter(1.0, 0.0))
        assert distribution.low <= ends[0] <= ends[1] <= distribution.high
    for low in (0.0, -1.0):
        with refusing(SAID, "low must be > 0, got"):
            LogUniform(low, 1.0)


def test_every_whole_number_of_its_bounds_has_the_same_share() -> None:
    six = uniform_int(-2, 3)
    assert [value(six, (i + 0.5) / 6.0) for i in range(6)] == [-2, -1, 0, 1, 2, 3]
    assert value(six, 0.0, own=7) == -2
    for low, high in [(-2, 3), (0, 2**32 - 1), (5, 5), (-(2**52), 2**52 - 1), (1, 2**53 - 1)]:
        assert value(uniform_int(low, high), math.nextafter(1.0, 0.0)) == high
    drawn = six.values(uniform_numbers("terrain.seed", 0, 6000), None)
    counts = np.bincount(drawn.astype(int) + 2)
    assert np.abs(counts - 1000).max() < 120  # four standard deviations of a number


@pytest.mark.parametrize(
    ("low", "high", "message"),
    [
        ("a", 1.0, "low must be a number, got a"),
        (None, 1.0, "low must be a number, got None"),
        (True, 1.0, "low must be a number, got True"),
        (0.0, [1.0], "high must be a number, got [1.0]"),
        (-math.inf, 1.0, "low must be finite, got -inf"),
        (0.0, math.nan, "high must be finite, got nan"),
        (2.0, 1.0, "high must be >= low = 2.0, got 1.0"),
    ],
)
def test_bounds_are_finite_numbers_in_order(low: Any, high: Any, message: str) -> None:
    for distribution in (uniform, LogUniform, scaled):
        with refusing(SAID) as caught:
            distribution(low, high)
        assert str(caught.value) == message


@pytest.mark.parametrize(
    ("low", "high", "message"),
    [
        (0.0, 1, "low must be a whole number, got 0.0"),
        (0, True, "high must be a whole number, got True"),
        (0, "9", "high must be a whole number, got 9"),
        (3, 2, "high must be >= low = 3, got 2"),
        (0, 2**53, "high must be < low + 2^53 = 9007199254740992, got 9007199254740992"),
        (-1, 2**53 - 1, "high must be < low + 2^53 = 9007199254740991, got 9007199254740991"),
    ],
)
def test_bounds_of_whole_numbers_are_whole_and_in_order(low: Any, high: Any, message: str) -> None:
    with refusing(SAID) as caught:
        uniform_int(low, high)
    assert str(caught.value) == message


def test_bounds_may_be_whole_or_of_numpy() -> None:
    whole: Any = np.int64(1)
    assert uniform(0, whole) == uniform(0.0, 1.0)
    assert repr(uniform(0, 1)) == "Uniform(low=0.0, high=1.0)"
    assert repr(uniform_int(whole, whole)) == "UniformInt(low=1, high=1)"
    assert uniform(1.0, 1.0).high == uniform_int(1, 1).low


def test_draws_of_two_paths_are_independent() -> None:
    paths = [
        *("start.approach", "start.track_phase", "drive.speed", "terrain.friction", "terrain.seed"),
        *("robot.belly[0][1]", "robot.belly[1][0]", "robot.belly[01]"),  # the same letters
        *("terrain.left.height", "terrain.right.height", "gravity", "gravitz", "ravity", ""),
    ]
    count = 4000
    drawn = np.array([uniform_numbers(path, 3, count) for path in paths])
    correlations = np.corrcoef(drawn)[np.triu_indices(len(paths), 1)]
    assert np.abs(correlations).max() < 4.5 / math.sqrt(count)  # standard errors, of 91 pairs
    # Neither does the next number, or the previous one.
    ahead = np.corrcoef(np.vstack([drawn[:, 1:], drawn[:, :-1]]))
    assert np.abs(ahead - np.diag(np.diag(ahead))).max() < 4.5 / math.sqrt(count)


def test_levels_are_taken_in_turn_and_slow_runs_last_longer() -> None:
    base = Scenario(ROBOT, c2d.terrains.step(0.05), duration=3.0)
    vary = {
        "drive.speed": Levels((0.1, 0.5, 1.0), spread=0.02),
        "duration": Levels((10.0, 2.0, 1.0), along="drive.speed"),
    }
    variation = Variation.read(base, vary, [])
    plan = planned(base, variation, 12)
    speeds, durations = plan.drawn["drive.speed"] / base.drive.speed, plan.drawn["duration"]
    assert speeds == pytest.approx(np.tile([0.1, 0.5, 1.0], 4), rel=0.02)
    assert len(set(speeds.tolist())) == 12  # each with its own scatter
    assert durations.tolist() == [30.0, 6.0, 3.0] * 4
    # Whatever was planned before, the next runs continue in turn; each sample begins one later.
    planner = Planner(variation, Variation.read(base, {"gravity": uniform(9.0, 10.0)}, []), 0, 3)
    for k, world in enumerate(planner.worlds(base, [])):
        whole = planner.runs(world, 0, 5).drawn["duration"]
        assert whole.tolist() == ([30.0, 6.0, 3.0] * 3)[k : k + 5]
        assert planner.runs(world, 2, 5).drawn["duration"].tolist() == whole[2:].tolist()


def test_a_field_that_a_study_doubles_is_doubled_at_every_level() -> None:
    fast = Scenario(ROBOT, c2d.terrains.step(0.05), drive=c2d.Drive(speed=0.8))
    variation = Variation.read(fast, {"drive.speed": Levels((0.1, 1.0))}, [])
    planner = scaled_draws(Planner(variation, Variation({}), 0), {"drive.speed": 2.0})
    (world,) = planner.worlds(fast, [])
    assert planner.runs(world, 0, 2).drawn["drive.speed"].tolist() == pytest.approx([0.08, 0.8])


def test_as_many_runs_are_planned_as_repeats_are_asked_for() -> None:
    """Also if nothing varies, so that no numbers are drawn."""
    base = c2d.Scenario(c2d.robots.engineer(), c2d.terrains.step(0.05))
    planner = Planner(Variation({}), Variation({}), 0)
    (world,) = planner.worlds(base, [])
    assert len(planner.runs(world, 2, 5).checked) == 3


def test_the_numbers_of_a_path_are_those_of_its_letters_and_the_seed() -> None:
    """Runs that a store has from another version are found by them."""
    expected = np.random.default_rng((7, *b"drive.speed")).random(4)
    assert uniform_numbers("drive.speed", 7, 4).tolist() == expected.tolist()


@pytest.mark.parametrize("path", ["start.approach", "terrain.seed", "a"])
def test_more_repeats_go_on_with_the_same_numbers(path: str) -> None:
    whole = uniform_numbers(path, 7, 1000)
    for count in (0, 1, 2, 3, 10, 999):
        assert uniform_numbers(path, 7, count).tolist() == whole[:count].tolist()


def test_draws_of_two_seeds_are_independent() -> None:
    seeds = [0, 1, 2, 3, 2**32 - 1, 2**32, 2**63, 2**64 - 1]
    drawn = np.array([uniform_numbers("drive.speed", seed, 4000) for seed in seeds])
    correlations = np.corrcoef(drawn)[np.triu_indices(len(seeds), 1)]
    assert np.abs(correlations).max() < 4.0 / math.sqrt(4000)  # standard errors, of 28 pairs


def test_the_numbers_of_a_repeat_depend_on_path_seed_and_repeat_alone() -> None:
    numbers = uniform_numbers("drive.speed", 0, 1000)
    assert numbers.tolist() == uniform_numbers("drive.speed", 0, 1000).tolist()
    assert numbers[:20].tolist() == uniform_numbers("drive.speed", 0, 20).tolist()
    for path, seed in [("drive.speed", 1), ("drive.speed", 2**64 - 1), ("start.approach", 0)]:
        other = uniform_numbers(path, seed, 1000)
        assert abs(np.corrcoef(numbers, other)[0, 1]) < 0.1  # three standard errors of 1000


def test_the_numbers_fill_the_interval_evenly() -> None:
    numbers = uniform_numbers("start.approach", 0, 10_000)
    assert numbers.min() >= 0.0
    assert numbers.max() < 1.0
    counts, _ = np.histogram(numbers, bins=10, range=(0.0, 1.0))
    assert np.abs(counts - 1000).max() < 120  # four standard deviations of a bin


def test_the_default_varies_approach_phase_speed_and_friction_in_their_ranges() -> None:
    found = drawn(Scenario(ROBOT, c2d.terrains.step(0.05)))
    assert list(found) == DEFAULT_PATHS
    bounds = [(0.1 - 0.365 / 8, 0.1 + 0.365 / 8), (0.0, 0.048), (0.392, 0.408), (0.882, 0.918)]
    for (low, high), values in zip(bounds, found.values(), strict=True):
        assert low <= values.min() < low + 0.1 * (high - low)
        assert high - 0.1 * (high - low) < values.max() <= high


def test_the_default_distributions_are_those_of_the_documentation() -> None:
    near = Scenario(ROBOT, c2d.terrains.step(0.05), start=c2d.Start(approach=0.5))
    found: Any = Variation.read(near, None, []).distributions
    quarter = ROBOT.outline.axle_distance / 4.0
    approach, phase, *scales = (found[path] for path in DEFAULT_PATHS)
    assert (approach.low, approach.high) == pytest.approx((-quarter / 2, quarter / 2))
    assert phase == shifted(0.0, ROBOT.outline.grouser_pitch)
    assert scales == [scaled(0.98, 1.02)] * 2


def test_a_number_too_long_for_a_float_is_scaled() -> None:
    cell = Scenario(ROBOT, c2d.terrains.step(0.05), duration=2**60 + 1)
    assert draw(cell, {"duration": scaled(0.5, 0.5)}) == {"duration": 2.0**59}


def test_the_default_approach_is_never_below_0() -> None:
    near = Scenario(ROBOT, c2d.terrains.step(0.05), start=c2d.Start(approach=0.01))
    approach = drawn(near)["start.approach"]
    assert approach.min() >= 0.0
    assert np.ptp(approach) == pytest.approx(0.365 / 4, rel=0.05)


def test_the_default_distances_are_those_of_the_base_in_every_cell() -> None:
    base = Scenario(ROBOT, c2d.terrains.step(0.05))
    other = c2d.Robot.simple(5.0, axle_distance=0.2, radius=0.03, track=c2d.LineOfWheels(9))
    here, there = drawn(base), drawn(base.replace({"robot": other}), base=base)
    assert {path: v.tolist() for path, v in here.items()} == {
        path: v.tolist() for path, v in there.items()
    }


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_a_default_speed_never_exceeds_the_drivetrains(direction: float) -> None:
    fastest = Scenario(ROBOT, c2d.terrains.step(0.05), drive=c2d.Drive(speed=direction * 1.39))
    speeds = direction * drawn(fastest)["drive.speed"]
    assert speeds.max() == 1.39
    assert speeds.min() < 1.37
    assert (speeds < 1.39).sum() == pytest.approx(100, abs=30)  # only the faster half is cut


def test_the_friction_of_lanes_is_that_of_every_lane() -> None:
    lanes = VARIANTS["belt-lanes"]
    assert isinstance(lanes.terrain, Lanes)
    found = draw(lanes, {"terrain.friction": scaled(0.5, 0.5)})
    sides = [lanes.terrain.left, lanes.terrain.right, lanes.terrain.middle]
    assert list(found) == [f"terrain.{side}.friction" for side in ("left", "right", "middle")]
    own = [side.friction for side in sides if side is not None]
    assert list(found.values()) == pytest.approx([0.5 * friction for friction in own])
    assert list(drawn(lanes)) == DEFAULT_PATHS


@pytest.mark.parametrize(
    ("swept", "kept"),
    [
        ("start.approach", ["start.track_phase", "drive.speed", "terrain.friction"]),
        ("start.track_phase", ["start.approach", "drive.speed", "terrain.friction"]),
        ("start", ["drive.speed", "terrain.friction"]),
        ("drive.speed", DEFAULT_PATHS),
    ],
)
def test_the_default_does_not_undo_what_is_swept(swept: str, kept: list[str]) -> None:
    found = drawn(Scenario(ROBOT, c2d.terrains.step(0.05)), swept=(swept,))
    assert list(found) == kept


@pytest.mark.parametrize("name", VARIANTS)
def test_the_default_draws_valid_scenarios_of_every_variant(name: str) -> None:
    drawn(VARIANTS[name])


@pytest.mark.parametrize(
    ("vary", "message"),
    [
        (["start.approach"], "vary must be a mapping from paths to distributions, got ["),
        ({3: uniform(0.0, 1.0)}, "vary must have dotted paths as keys, got 3"),
        (
            {"start.approach": 0.1},
            "vary['start.approach'] must be uniform(low, high), uniform_int(low, high),"
            " scaled(low, high), shifted(low, high) or a frozen distribution of SciPy, got 0.1",
        ),
        (
            {"start.approach": (0.05, 0.15)},
            "vary['start.approach'] must be uniform(low, high), uniform_int(low, high),"
            " scaled(low, high), shifted(low, high) or a frozen distribution of SciPy,"
            " got (0.05, 0.15)",
        ),
        *(
            (
                {"terrain.height": distribution},
                "vary['terrain.height'] must not replace the values of `over` or `unknown`, got"
                f" {distribution}; scaled(low, high) and shifted(low, high) vary about them",
            )
            for distribution in (uniform(0, 1), uniform_int(0, 1))
        ),
    ],
)
def test_an_invalid_variation_is_refused_by_name(vary: Any, message: str) -> None:
    base = Scenario(ROBOT, c2d.terrains.step(0.05))
    with refusing(SAID) as caught:
        Variation.read(base, vary, ["terrain.height"])
    assert str(caught.value).startswith(message)


def test_given_distributions_are_drawn_as_they_are_and_may_scale_swept_values() -> None:
    base = Scenario(ROBOT, c2d.terrains.step(0.05))
    vary = {"terrain.friction": uniform(0.0, 400.0), "terrain.height": scaled(0.5, 1.5)}
    variation = Variation.read(base, vary, ["terrain.height"])
    assert dict(variation.distributions) == dict[str, Any](vary)
    plan = planned(base, variation, 10)
    refused = [isinstance(each, c2d.ScenarioError) for each in plan.checked]
    assert refused == (plan.drawn["terrain.friction"] > 100.0).tolist()
    assert 0 < sum(refused) < 10
    lanes = VARIANTS["belt-lanes"]
    with refusing(SAID, r"must be a known field, got .*: Lanes has"):
        draw(lanes, vary)


@pytest.mark.parametrize("is_first", [False, True])
@pytest.mark.parametrize("others", [{}, {"robot.drivetrain.no_load_speed": uniform(1.0, 1.0)}])
def test_a_default_draw_that_breaks_a_rule_with_other_draws_is_dropped(
    is_first: bool, others: dict[str, Any]
) -> None:
    base = Scenario(ROBOT, c2d.terrains.flat(), drive=c2d.Drive(speed=0.4))
    slow = {"robot.drivetrain.max_speed": uniform(0.4, 0.4), **others}
    usual = c2d.variability.of_contact()
    vary = slow | usual if is_first else usual | slow
    found = c2d.sweep(base, {}, vary=vary, repeats=6, progress=False)
    assert found["drawn_speed"].max() == 0.4
    assert found["drawn_speed"].min() < 0.4
    assert len(set(found["drawn_friction"].values.tolist())) == 6


@pytest.mark.parametrize("distribution", [uniform(1.0, 9.0), scaled(1.0, 2.0)])
def test_a_whole_number_asks_for_its_own_distribution(distribution: Any) -> None:
    for name, path in [
        ("line-flat", "robot.track.count"),
        ("segmental-step", "robot.track.return_roller_count"),
        ("gears-diagonal-barrier", "solver.iterations"),
    ]:
        cell = VARIANTS[name]
        with refusing(SAID) as caught:
            draw(cell, {path: distribution})
        assert str(caught.value) == (
            f"{path} must be drawn as a whole number, got {distribution}; use"
            " uniform_int(low, high)"
        )
    cell = VARIANTS["line-flat"]
    drawn = draw(cell, {"gravity": uniform_int(8, 8)})
    assert drawn == {"gravity": 8}  # a whole number is a number, too


@pytest.mark.parametrize(
    ("path", "held"), [("goal", None), ("robot.name", "engineer"), ("robot", None)]
)
def test_only_a_number_is_scaled(path: str, held: Any) -> None:
    base = Scenario(ROBOT, c2d.terrains.step(0.05))
    with refusing(SAID, r"must be a number for a distribution to vary about, got ") as caught:
        draw(base, {path: scaled(0.9, 1.1)})
    assert caught.value.path == path
    assert held is None or caught.value.value == held


def test_a_path_that_is_no_field_lists_the_fields() -> None:
    base = Scenario(ROBOT, c2d.terrains.step(0.05))
    with refusing(SAID, r"got Uniform\(low=0\.0, high=0\.1\): .*did you mean height\?"):
        draw(base, {"terrain.hight": uniform(0.0, 0.1)})


def test_draws_that_differ_in_the_place_of_a_star_have_a_column_each() -> None:
    """The heights of all corners, and both coordinates of one of them."""
    paths = {"robot.belly[*][1]": shifted(-0.01, 0.0), "robot.belly[1][*]": shifted(0.0, 1e-3)}
    base = Scenario(ROBOT, c2d.terrains.step(0.02), duration=0.0)
    table = quiet(base, {}, vary=paths, repeats=3)
    columns = [table[f"drawn_robot_belly_{name}"] for name in ("all_1", "1_all")]
    assert [column.attrs["path"] for column in columns] == list(paths)
    heights, corners = (column.values for column in columns)
    assert (heights < 0.0).all()
    assert (corners > 0.1).all()
