"""Sensitivity to uncertain parameters: indices known in closed form, slopes of known friction."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import stats  # type: ignore[import-untyped]

import crawler2d as c2d
from crawler2d.studies.boundary import range_of
from crawler2d.studies.sobol import Indices, bounds, estimate, points
from crawler2d.sweeps.store import stored_rows
from crawler2d.variation.draws import Variation
from tests.shared import ROBOT, SOAK, refused
from tests.sweeps.small import interrupt_after

Output = Callable[[Any], Any]

# Coarse: the outcomes are the same in half of the time.
SLOPE = c2d.Scenario(ROBOT, c2d.terrains.ramp(math.atan(0.7)), solver=c2d.Solver(accuracy=1e-5))
UNKNOWN: dict[str, Any] = {
    "terrain.friction": c2d.uniform(0.5, 1.0),
    "robot.drivetrain.max_torque": c2d.uniform(30.0, 40.0),
}
QUICK = c2d.Until(threshold=0.5, min_runs=5, max_runs=10)


def found_of(scenario: Any = SLOPE, **how: Any) -> Any:
    given = {"unknown": UNKNOWN, "samples": 32, "until": QUICK, "progress": False, **how}
    return c2d.studies.sensitivity(scenario, **given)


@pytest.fixture(scope="module")
def slope() -> Any:
    return found_of()


def outputs_of(output: Output, sizes: list[int], count: int, seed: int = 0) -> Any:
    f_a, f_b, *f_ab = (output(page.T) for page in points(count, sizes, seed))
    return f_a, f_b, np.array(f_ab)


def either(rough: int = 1, one: float = 0.3, other: float = 0.3) -> tuple[Output, Indices]:
    """Yes if one number is low, or if the sum of two (modulo 1) that are swapped together is.

    With a large `rough`, the boundary between yes and no is as rough as chance. A third factor has
    no influence.
    """

    def output(x: Any) -> Any:
        low = (rough * x[0]) % 1.0 < one
        both = (rough * (x[1] + x[2])) % 1.0 < other
        return (low | both).astype(float)

    rate = 1.0 - (1.0 - one) * (1.0 - other)
    spread = np.array([one * (1.0 - one), other * (1.0 - other), 0.0])
    others = np.array([1.0 - other, 1.0 - one, 1.0])  # no is decided by the other
    variance = rate * (1.0 - rate)
    return output, Indices(spread * others**2 / variance, spread * others / variance)


def test_the_indices_of_ishigamis_function_are_those_of_its_closed_form() -> None:
    a, b = 7.0, 0.1

    def output(x: Any) -> Any:
        angle = math.pi * (2.0 * x - 1.0)
        return np.sin(angle[0]) * (1.0 + b * angle[2] ** 4) + a * np.sin(angle[1]) ** 2

    alone, second = (1.0 + b * math.pi**4 / 5.0) ** 2 / 2.0, a**2 / 8.0
    together = 8.0 * b**2 * math.pi**8 / 225.0
    whole = alone + second + together
    first, total = estimate(*outputs_of(output, [1, 1, 1], 2**13))
    # Over 20 seeds the largest error was 0.011.
    assert first == pytest.approx(np.array([alone, second, 0.0]) / whole, abs=0.02)
    assert total == pytest.approx(np.array([alone + together, second, together]) / whole, abs=0.02)


def test_the_indices_of_a_yes_or_no_are_those_of_its_closed_form() -> None:
    output, truth = either()
    found = estimate(*outputs_of(output, [1, 2, 1], 2**12))
    assert found.first == pytest.approx(truth.first, abs=0.03)  # independent points err by 0.015
    assert found.total == pytest.approx(truth.total, abs=0.03)
    assert found.total[2] == found.first[2] == 0.0  # swaps that change nothing


DESIGNS, LEAST_HELD = (200, 0.90) if SOAK else (100, 0.88)
"""Of these, if each holds with a probability of 0.95, fewer hold in one case in 500 at most."""


def held(case: tuple[Output, Indices], count: int, designs: int) -> Any:
    """Fraction of designs whose intervals contain first and total indices, shape (2, d)."""
    output, truth = case
    inside = []
    for seed in range(designs):
        f_a, f_b, f_ab = outputs_of(output, [1, 2, 1], count, seed)
        low, high = bounds(f_a, f_b, f_ab, seed=seed)
        inside.append((np.array(low) <= truth) & (truth <= np.array(high)))
    return np.mean(inside, axis=0)


@pytest.mark.parametrize("rough", [pytest.param(1, marks=pytest.mark.soak), 7919])
def test_intervals_cover_the_indices_as_often_as_claimed(rough: int) -> None:
    assert (held(either(rough), 256, DESIGNS) >= LEAST_HELD).all()


def test_intervals_cover_indices_that_depend_on_few_swaps() -> None:
    case = either(rough=7919, one=0.5, other=0.01)
    assert case[1].total[1] == pytest.approx(0.02, abs=0.001)
    assert (held(case, 64, DESIGNS) >= LEAST_HELD).all()
    output, _ = case
    f_a, f_b, f_ab = outputs_of(output, [1, 2, 1], 64)
    low, high = bounds(f_a, f_b, f_ab)
    assert low.total[2] == 0.0 < high.total[2]


def test_a_larger_design_begins_with_the_smaller_one() -> None:
    small, large = points(32, [1, 2], seed=3), points(64, [1, 2], seed=3)
    assert np.array_equal(small, large[:, :32])
    a, b, first, second = small
    assert np.array_equal(first[:, 0], b[:, 0])
    assert np.array_equal(first[:, 1:], a[:, 1:])
    assert np.array_equal(second[:, 0], a[:, 0])
    assert np.array_equal(second[:, 1:], b[:, 1:])


def test_friction_decides_a_slope_and_ample_torque_nothing(slope: Any) -> None:
    # The friction also varies between runs, which is a separate factor.
    assert slope["unknown"].values.tolist() == ["friction", "max_torque", "run to run"]
    found = slope.isel(model=0)
    assert found["first"].sel(unknown="friction").item() > 0.8
    assert (found["total"].sel(unknown=["max_torque", "run to run"]) < 0.15).all()
    assert found["first_low"].sel(unknown="friction") > found["total_high"].sel(
        unknown="max_torque"
    )
    # The tangent of the slope; its run-up counts for a per cent.
    friction = found.sel(unknown="friction")
    assert friction["bracket_low"].item() == pytest.approx(0.7, abs=0.015)
    assert 0.0 < friction["bracket_high"].item() - friction["bracket_low"].item() <= 0.005
    assert friction["rises"].item()
    torque = found.sel(unknown="max_torque")
    assert math.isnan(torque["bracket_low"].item())
    assert torque["monotone"].item()
    assert (torque["range_low"].item(), torque["own"].item()) == (30.0, 6.0)
    assert math.isnan(found["own"].sel(unknown="run to run").item())


def test_the_indices_are_those_of_the_outcomes_in_the_table(slope: Any) -> None:
    found = slope.isel(model=0)
    f_a, f_b, *f_ab = (found["outcome"] == "cleared").to_numpy().astype(float)
    own = estimate(f_a, f_b, np.array(f_ab))
    assert found["first"].to_numpy() == pytest.approx(own.first)
    assert found["total"].to_numpy() == pytest.approx(own.total)
    assert found["rate"].item() == pytest.approx(np.mean([f_a, f_b]))
    assert found["matrix"].values.tolist()[2] == "A, friction of B"
    made = found["tried"].notnull().sum().item()
    assert slope.attrs["settings"] == 5 + made
    assert slope.attrs["runs"] > 5 * 32 + 5 * made


def test_where_all_runs_clear_there_are_no_indices_and_no_more_runs(tmp_path: Path) -> None:
    store = tmp_path / "a.sqlite"
    easy = SLOPE.replace({"terrain.angle": 0.2, "robot.drivetrain.max_torque": 30.0})
    found = found_of(easy, store=store).isel(model=0)
    assert found["rate"].item() == 1.0
    assert found["caveat"].item() == "cannot tell from a rate of 1.00"
    assert found["first"].isnull().all()
    assert found["total_high"].isnull().all()
    assert found["count"].item() == 32
    assert (found["outcome"].sel(matrix="A") == "cleared").all()
    assert (found["outcome"].drop_sel(matrix="A") == "").all()
    along = int(found["tried"].notnull().sum())
    assert len(list(stored_rows(store))) <= 32 + along * 10


def test_the_same_seed_gives_the_same_runs_and_a_store_keeps_them(
    tmp_path: Path, slope: Any
) -> None:
    store = tmp_path / "a.sqlite"
    assert found_of(store=store, threads=1).identical(slope)
    count = len(list(stored_rows(store)))
    assert count == slope.attrs["runs"]
    assert found_of(store=store).identical(slope)
    assert len(list(stored_rows(store))) == count
    more = found_of(store=store, samples=64)
    assert len(list(stored_rows(store))) == count + 32 * 5
    assert more["outcome"].isel(sample=slice(0, 32)).equals(slope["outcome"])
    assert not found_of(seed=1)["outcome"].equals(slope["outcome"])


def test_ctrl_c_is_reported_and_the_store_can_be_continued(tmp_path: Path, slope: Any) -> None:
    store = tmp_path / "a.sqlite"

    with pytest.raises(c2d.BatchInterrupted, match=r"a\.sqlite keeps them"):
        found_of(store=store, progress=interrupt_after(5), threads=1)
    assert len(list(stored_rows(store))) > 5
    assert found_of(store=store).identical(slope)


def test_any_outcome_can_be_asked_about(slope: Any) -> None:
    slips = found_of(outcome="slipping", models={"belt": {}})
    assert slips["outcome"].to_numpy().tolist() == slope["outcome"].to_numpy().tolist()
    f_a, f_b, *f_ab = (slips["outcome"][0] == "slipping").to_numpy().astype(float)
    assert slips["total"].to_numpy()[0] == pytest.approx(estimate(f_a, f_b, np.array(f_ab)).total)
    friction = slips.isel(model=0).sel(unknown="friction")
    assert not friction["rises"].item()
    assert slips["rate"].attrs["long_name"] == "rate of slipping"


def test_where_nothing_varies_the_unknowns_decide_everything() -> None:
    wheels = SLOPE.replace({"robot.track": c2d.LineOfWheels(4)})
    unknown = {
        "terrain.friction": c2d.uniform(0.5, 1.0),
        "robot.track.count": c2d.uniform_int(3, 5),
    }
    found = found_of(wheels, unknown=unknown, vary={}).isel(model=0)
    assert found["unknown"].values.tolist() == ["friction", "robot_track_count"]
    assert found["first"].sel(unknown="friction").item() > 0.8
    # A number of wheels has no boundary, but indices, and a row in the figure.
    assert found["tried"].sel(unknown="robot_track_count").isnull().all()
    assert found["total"].sel(unknown="robot_track_count").item() < 0.2
    from matplotlib import pyplot as plt  # noqa: PLC0415

    rows = found.plot(show="boundary").get_yticklabels()
    assert [row.get_text() for row in rows] == ["friction", "robot track count"]
    plt.close("all")


def test_the_range_of_whole_numbers_is_from_the_least_to_the_greatest() -> None:
    wheels, path = SLOPE.replace({"robot.track": c2d.LineOfWheels(4)}), "robot.track.count"
    for given in (c2d.uniform_int(3, 5), stats.randint(3, 6)):
        unknowns = Variation.read(wheels, {path: given}, [])
        assert range_of(unknowns, path, wheels).first == (3.0, 5.0)


def test_all_elements_of_a_path_move_together_along_its_range() -> None:
    path = "robot.belly[*][1]"
    unknowns = Variation.read(SLOPE, {path: c2d.shifted(-0.01, 0.02)}, [])
    over = range_of(unknowns, path, SLOPE)
    assert ROBOT.belly is not None
    assert over.first == pytest.approx((ROBOT.belly[0][1] - 0.01, ROBOT.belly[0][1] + 0.02))
    assert over.own == ROBOT.belly[0][1]
    moved = over.at(over.own + 0.005).robot.belly
    assert moved is not None
    shifts = [
        [new[k] - old[k] for k in (0, 1)] for new, old in zip(moved, ROBOT.belly, strict=True)
    ]
    assert np.allclose(shifts, [0.0, 0.005])


def test_the_range_of_an_unbounded_distribution_is_1_to_99_percent() -> None:
    given = {
        "robot.mass": stats.norm(21.0, 1.0),
        "robot.center_of_mass[0]": c2d.scaled(0.5, 2.0),
        "solver.iterations": c2d.uniform_int(1, 6),
    }
    behind = SLOPE.replace({"robot.center_of_mass[0]": -0.01})
    unknowns = Variation.read(behind, given, [])
    mass, centre, count = (range_of(unknowns, path, behind) for path in given)
    assert mass.first == pytest.approx((18.674, 23.326), abs=0.001)
    assert centre.first == (-0.02, -0.005)  # from low to high
    assert centre.is_line
    assert not count.is_line


def test_invalid_arguments_are_refused_by_name() -> None:
    cases: list[tuple[dict[str, Any], str]] = [
        ({"unknown": None}, "unknown"),
        ({"unknown": {}}, "unknown"),
        ({"unknown": ["terrain.friction"]}, "unknown"),
        ({"unknown": {"terrain.friction": 0.5}}, "unknown['terrain.friction']"),
        ({"unknown": {"terrain.friction": c2d.uniform(0.5, 1.0)}, "vary": {}}, "unknown"),
        ({"samples": 100}, "samples"),
        ({"samples": 16}, "samples"),
        ({"models": {"a": 4}}, "models['a']"),
        ({"models": []}, "models"),
        ({"outcome": "clear"}, "outcome"),
        ({"repeats": 5}, "repeats"),
        ({"until": 5}, "until"),
        ({"seed": -1}, "seed"),
        ({"vary": {"terrain.friction": c2d.uniform(0, 1)}}, "vary['terrain.friction']"),
        (
            {"unknown": {"robot.mass": c2d.shifted(-30.0, 1.0)}},
            "cell[model=smooth belt, mass=-8.8].robot.mass",
        ),
        (
            {"models": {"rough": {"terrain.friction": 0.9}}},
            "unknown['terrain.friction']",
        ),
    ]
    for how, path in cases:
        assert refused(lambda how=how: found_of(**how)).path == path
    with pytest.raises(c2d.ScenarioError, match="unknown"):
        c2d.studies.sensitivity(SLOPE)


def test_a_figure_draws_one_model_or_its_boundaries() -> None:
    from matplotlib import pyplot as plt  # noqa: PLC0415

    models = {"belt": c2d.BeltTrack(), "on ice": {"robot.mass": 20.0}}
    few = c2d.Until(threshold=0.5, min_runs=5, max_runs=5)
    found = found_of(models=models, until=few)
    with pytest.raises(c2d.ScenarioError, match="must have one model"):
        found.plot()
    with pytest.raises(c2d.ScenarioError, match="show"):
        found.sel(model="belt").plot(show="bounds")
    alone = found.sel(model="belt", unknown="friction").plot()
    assert [label.get_text() for label in alone.get_yticklabels()] == ["friction"]
    _, ax = plt.subplots()
    one = found.sel(model="belt")
    assert one.plot(ax) is ax
    assert ax.get_yticklabels()[0].get_text() == "friction"
    rate = one["rate"].item()
    assert f"cleared in {rate:.2f} of 64 runs" in ax.get_title(loc="left")
    _, below = plt.subplots()
    one.plot(below, show="boundary")
    assert [text.get_text() for text in below.get_yticklabels()] == ["friction", "max torque [N m]"]
    assert any("to" in text.get_text() for text in below.texts)
    plt.close("all")
