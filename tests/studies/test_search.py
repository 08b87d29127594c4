"""A search finds the cheapest candidate that succeeds; fresh runs say how often."""

import random
from pathlib import Path
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d.results.record import Row
from crawler2d.studies.campaign import Tally
from crawler2d.studies.candidates import Candidate, FreshDraws, halve, ranked
from crawler2d.sweeps.plan import Planner
from crawler2d.sweeps.store import stored_rows
from crawler2d.variation.draws import Variation
from tests.shared import ROBOT, refused

BASE = c2d.Scenario(ROBOT, c2d.terrains.step(0.05), solver=c2d.Solver(accuracy=1e-5))
SPACE: Any = {
    "7 small": c2d.LineOfWheels(7, wheel_radius=0.032),
    "2 large": c2d.LineOfWheels(2),
    "3 large": c2d.LineOfWheels(3),
    "8 all round": c2d.CircumferentialWheels(8),  # too few for tight wheels
    "16 all round": c2d.CircumferentialWheels(16),
}
UNKNOWN: Any = {"terrain.friction": c2d.uniform(0.5, 1.0)}
EASY: Any = {"edge": c2d.terrains.knife_edge(0.03), "step": c2d.terrains.step(0.05)}
"""Two large wheels seize on the step, seven small ones on both."""


def search(**how: Any) -> Any:
    given = {"space": SPACE, "first": 4, "confirm": 10, "progress": False, **how}
    return c2d.studies.search(BASE, given.pop("space"), **given)


class Chances:
    """Replaces a study: every run of a candidate succeeds with a given probability."""

    def __init__(self, chances: dict[str, float], costs: list[float], seed: int = 0) -> None:
        any_world: Any = None
        until = c2d.Until(threshold=0.5)
        self.candidates = [
            Candidate(label, cost, [Tally(any_world, until)])
            for label, cost in zip(chances, costs, strict=True)
        ]
        self._chances = dict(zip(map(id, self.tallies()), chances.values(), strict=True))
        self._random = random.Random(seed)

    def tallies(self) -> list[Tally]:
        return [tally for each in self.candidates for tally in each.tallies]

    def simulate(self, due: Any) -> None:
        for tally, more in due:
            assert more > 0
            for _ in range(more):
                hit = self._random.random() < self._chances[id(tally)]
                tally.rows.append(Row("", "", "cleared" if hit else "seized", {}))


def halved(chances: dict[str, float], costs: list[float], seed: int = 0) -> list[Candidate]:
    study: Any = Chances(chances, costs, seed)
    rounds = halve(study, study.candidates, 0.95, 20)
    best = ranked(study.candidates, 0.95)
    assert all(each.rounds == rounds for each in best[:2])
    return best


def test_the_cheapest_of_those_that_succeed_is_found() -> None:
    chances = {"a": 0.2, "b": 0.5, "c": 1.0, "d": 0.99, "e": 1.0, "f": 0.0, "g": 0.9, "h": 1.0}
    best = halved(chances, [2, 3, 6, 5, 7, 1, 4, 8])
    assert [each.label for each in best[:2]] == ["d", "c"]
    counts = {each.label: each.count for each in best}
    assert counts["f"] == counts["a"] == 20
    assert counts["d"] == counts["c"] == 80


def test_an_expensive_candidate_returns_when_the_cheap_ones_fail() -> None:
    # Of 20 runs at 0.9, at most two fail in two of three cases: cheap ones displace the costly one.
    chances = {str(k): 0.9 for k in range(15)} | {"dear": 1.0}
    costs = [float(k) for k in range(15)] + [99.0]
    best = [halved(chances, costs, seed)[0] for seed in range(20)]
    assert sum(each.label == "dear" for each in best) >= 14


def test_if_none_reaches_the_goal_the_best_rate_wins() -> None:
    best = halved({"a": 0.1, "b": 0.6, "c": 0.3, "d": 0.0}, [1, 4, 2, 3])
    assert best[0].label == "b"
    assert best[0].rate < 0.95


def test_ties_go_by_the_order_of_the_labels() -> None:
    assert [each.label for each in halved({"b": 1.0, "a": 1.0, "c": 1.0}, [1, 1, 1])[:2]] == [
        "b",
        "a",
    ]
    assert [each.label for each in halved({"b": 0.0, "a": 0.0}, [2, 1])] == ["b", "a"]


def test_every_run_has_its_own_draw_of_variable_and_unknown_parameters() -> None:
    unknowns = Variation.read(BASE, UNKNOWN, ["terrain"], "unknown")
    variation = Variation.read(BASE, {"drive.speed": c2d.scaled(0.9, 1.1)}, ["terrain"])
    world = Planner(variation, Variation({}), 3).worlds(BASE, ("a",))[0]
    planner = FreshDraws(variation, unknowns, 3)
    whole = [each.text for each in planner.runs(world, 0, 6).checked]  # type: ignore[union-attr]
    parts: list[Any] = [c2d.Scenario.from_json(text) for text in whole]
    assert len({each.terrain.friction for each in parts}) == 6
    assert len({each.drive.speed for each in parts}) == 6
    # Run k is the same, whatever was planned before.
    assert [each.text for each in planner.runs(world, 4, 6).checked] == whole[4:]  # type: ignore[union-attr]
    # Sample k of the unknowns and repeat k of the rest are those of a sweep.
    table = c2d.sweep(
        BASE,
        {},
        unknown=UNKNOWN,
        vary={"drive.speed": c2d.scaled(0.9, 1.1)},
        samples=2,
        repeats=2,
        seed=3,
        progress=False,
    )
    swept = [c2d.Scenario.from_json(table["scenario"].values[k, k]) for k in range(2)]
    assert swept == parts[:2]


def test_the_fewest_wheels_that_clear_every_terrain_win() -> None:
    found = search(terrains=EASY)
    assert found.attrs["winner"] == "3 large"
    assert found["confirmed"].sel(candidate="3 large").item()
    assert found["cost"].sel(candidate="3 large").item() == 3.0
    assert found["rate"].dims == ("candidate", "terrain")
    assert found["confirmed_rate"].sel(candidate="3 large").values.tolist() == [1.0, 1.0]
    assert "2 large" in found["candidate"]
    assert found["rate"].sel(candidate="2 large").min() < 0.95
    assert found["ending"].sel(candidate="3 large").values.tolist() == ["", ""]
    assert "confirmed" in found.attrs["verdict"]


def test_invalid_candidates_are_left_out_and_counted() -> None:
    found = search()
    assert "8 all round" not in found["candidate"]
    assert found.attrs["refused"] == 1
    assert "candidate=8 all round" in found.attrs["refusals"]
    assert found.attrs["settings"] == 4
    error = refused(lambda: search(space={"a": c2d.CircumferentialWheels(8)}))
    assert error.path == "cell[candidate=a, terrain=step].robot.track.count"


def test_a_candidate_is_confirmed_on_fresh_runs(tmp_path: Path) -> None:
    store = tmp_path / "a.sqlite"
    found = search(terrains=EASY, unknown=UNKNOWN, samples=3, store=store)
    assert len(list(stored_rows(store))) == found.attrs["runs"]  # no run was made twice
    chosen = [found.attrs["winner"], found.attrs["runner_up"]]
    counts = found["confirmed_count"]
    assert (counts.sel(candidate=chosen) == 10).all()
    assert counts.sum() == 40
    screened = int(found["count"].sum())
    assert found.attrs["runs"] == screened + 40 + 2 * 2 * 3 * 3  # 3 robots, 10 // 3 runs each
    best = found.sel(candidate=chosen[0], terrain="step")
    rate = best["confirmed_rate"].item()
    assert 0.0 < rate < 1.0
    interval = c2d.wilson(round(10 * rate), 10)
    assert (rate, best["confirmed_low"].item(), best["confirmed_high"].item()) == interval
    assert best["band_low"] <= best["band_median"]
    assert found["band_low"].notnull().sum() == 4
    # The search does not depend on the confirmation, nor this on the search.
    other = search(terrains=EASY, unknown=UNKNOWN, samples=3, store=store, confirm=5)
    assert other["rate"].equals(found["rate"])
    assert len(list(stored_rows(store))) == found.attrs["runs"]


def test_the_verdict_says_if_no_candidate_reaches_the_goal() -> None:
    wall = {"wall": c2d.terrains.step(0.3)}
    found = search(terrains=wall)
    assert not found["confirmed"].any()
    assert "none of which reached 0.95" in found.attrs["verdict"]
    assert "below the goal" in found.attrs["verdict"]
    assert found.attrs["winner"] == "7 small"  # all clear none: the first label


def test_the_same_seed_gives_the_same_runs_and_another_gives_others(tmp_path: Path) -> None:
    store = tmp_path / "a.sqlite"
    first = search(unknown=UNKNOWN, samples=2, seed=5, store=store)
    assert search(unknown=UNKNOWN, samples=2, seed=5).identical(first)
    other = search(unknown=UNKNOWN, samples=2, seed=6, store=store)
    assert len(list(stored_rows(store))) == first.attrs["runs"] + other.attrs["runs"]


def test_an_objective_takes_the_place_of_the_wheels() -> None:
    def mass_of(scenario: c2d.Scenario) -> float:
        return scenario.robot.mass

    space: Any = {"heavy": {"robot.mass": 25.0}, "light": {"robot.mass": 20.0}}
    found = search(space=space, objective=mass_of, terrains=EASY)
    assert found.attrs["winner"] == "light"
    assert found.attrs["objective"] == "mass_of"
    error = refused(lambda: search(space=space))
    assert error.path == "objective"
    assert "heavy has no wheels" in error.rule


def test_a_single_candidate_is_confirmed_alone() -> None:
    found = search(space=[c2d.LineOfWheels(3)])
    assert found.attrs["winner"] == "LineOfWheels(3)"
    assert found.attrs["runner_up"] == ""
    assert found["confirmed_count"].values.tolist() == [[10]]


def test_a_search_draws_cost_against_the_lowest_rate() -> None:
    from matplotlib import pyplot as plt  # noqa: PLC0415

    found = search(terrains=EASY)
    _, ax = plt.subplots()
    assert found.plot(ax) is ax
    assert ax.get_xlabel() == "wheels a side"
    texts = [text.get_text() for text in ax.get_legend().get_texts()]
    assert any(text.startswith("winner: 3 large, fresh runs 1.000") for text in texts)
    assert "goal: 0.95" in texts
    assert "friction" in ax.get_title(loc="left")
    assert "seed" not in ax.get_title(loc="left")
    assert found.sel(terrain="step").plot().get_ylabel() == "rate of clearing"
    alone = found.sel(candidate=found.attrs["winner"]).plot()
    assert any("winner" in text.get_text() for text in alone.get_legend().get_texts())
    plt.close("all")


@pytest.mark.parametrize(
    ("given", "path"),
    [
        ({"space": {}}, "space"),
        ({"space": {"a": 4}}, "space['a']"),
        ({"objective": 3}, "objective"),
        ({"objective": lambda _: "a"}, "objective of 7 small"),
        ({"objective": lambda _: float("nan")}, "objective of 7 small"),
        ({"terrains": {"a": 4}}, "terrains['a']"),
        ({"terrains": {}}, "terrains"),
        ({"at_least": 0.0}, "at_least"),
        ({"at_least": 1.5}, "at_least"),
        ({"first": 0}, "first"),
        ({"confirm": 0}, "confirm"),
        ({"until": c2d.Until()}, "until"),
    ],
)
def test_invalid_arguments_are_refused_by_name(given: Any, path: str) -> None:
    assert refused(lambda: search(**given)).path == path
