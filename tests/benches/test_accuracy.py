"""benches/accuracy: cells are stored, runs resume, verdicts hold, and the page reports results."""

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import crawler2d as c2d
from benches.accuracy import cells, runs, search
from benches.accuracy.__main__ import main
from benches.accuracy.cells import KINDS, Cell
from benches.accuracy.findings import (
    CELL_BOUND,
    Pairs,
    Study,
    cell_interval,
    cell_verdicts,
    collect,
    holm,
    mean,
    path_error,
    undecided,
    verdict_of,
)
from benches.accuracy.runs import Row, Store
from crawler2d.sweeps.statistics import Interval, newcombe_paired

COARSE, FINE = {"time_step": 2e-3}, {"time_step": 1e-3}
DRAWN = replace(search.draw("line of 3 round", 1, 0), height=0.0536)


def made(store: Store, cell: Cell, count: int) -> dict[int, Row]:
    runs.complete(store, [cell], {"coarse": COARSE}, count, threads=1)
    # The processor time differs each time.
    return {k: row._replace(processor=0.0) for k, row in store.rows(cell, COARSE).items()}


def some(outcomes: Sequence[bool]) -> list[Row]:
    names = {True: "cleared", False: "seized"}
    return [Row(i, names[bool(o)], 0.0, 0.0, 0.0, 1.0, 1.0, 0.01) for i, o in enumerate(outcomes)]


def study(store: Store, *drawn: Cell) -> Study:
    settings = {"coarse": COARSE, "fine": FINE}
    found = collect(store, drawn, settings, "fine")
    return Study(1, found, settings, "fine", "coarse", (400, 1600), store.builds())


@pytest.mark.parametrize("number", [1, 2])
def test_every_cell_of_a_set_is_a_valid_scenario(number: int) -> None:
    found = cells.read(cells.path_of(number))
    assert len({cell.name for cell in found}) == len(found)
    for cell in found:
        cell.scenario(FINE).validate()


def test_the_first_set_has_every_kind_of_robot_at_a_rate_in_between() -> None:
    found = cells.read(cells.path_of(1))
    assert [cell.kind for cell in found] == list(KINDS)
    assert all(0.15 <= cell.found["rate"] <= 0.85 for cell in found)


def test_the_second_set_has_the_cells_that_were_known_before() -> None:
    given = [cell for cell in cells.read(cells.path_of(2)) if cell.name.endswith(", given")]
    assert [(cell.what.model, cell.height, cell.friction) for cell in given] == [
        ("24 gears all round", 0.05, 0.6),
        ("lines of round wheels", 0.11, 0.9),
        ("line of 5 round, flippers", 0.35, 0.9),
        ("chains", 0.11, 0.9),
    ]
    assert given[1].center_of_mass == (0.026, 0.02)
    assert given[1].max_torque == 60.0


def test_a_set_reads_back_as_it_was_written(tmp_path: Path) -> None:
    drawn = [replace(search.draw(name, 3, 1), found={"rate": 0.5}) for name in KINDS]
    cells.write(tmp_path / "3.json", drawn)
    assert cells.read(tmp_path / "3.json") == drawn


def test_motors_have_rotors_only_in_cells_that_say_so() -> None:
    inertia = c2d.robots.engineer().drivetrain.rotor_inertia
    with_rotors = replace(DRAWN, rotors=True)
    found = [cell.scenario(COARSE).robot.drivetrain for cell in (DRAWN, with_rotors)]
    assert [drive.rotor_inertia for drive in found] == [0.0, inertia]
    assert inertia > 0.0
    # The key of a cell in stores that were written before cells had this field.
    assert runs.key(DRAWN) == "d6937f4c63930178"
    assert runs.key(with_rotors) != runs.key(DRAWN)


def test_draws_of_cells_repeat_and_differ_between_sets() -> None:
    assert search.draw("belt (a)", 1, 0) == search.draw("belt (a)", 1, 0)
    assert search.draw("belt (a)", 1, 0) != search.draw("belt (a)", 2, 0)


def test_runs_are_those_of_a_sweep() -> None:
    plans = runs.plan(DRAWN, COARSE, 3, seed=5)
    rows = runs.simulate(plans, range(3), threads=1)
    table = c2d.sweep(DRAWN.scenario(COARSE), {}, repeats=3, seed=5, threads=1, progress=False)
    assert [row.outcome for row in rows] == table.outcome.values.tolist()
    assert [row.x for row in rows] == table.final_x.values.tolist()


def test_every_setting_has_the_same_draws() -> None:
    coarse, fine = (runs.plan(DRAWN, setting, 4, seed=5) for setting in (COARSE, FINE))
    one, other = ([json.loads(plan.text) for plan in plans] for plans in (coarse, fine))
    for first, second in zip(one, other, strict=True):
        assert first.pop("solver") != second.pop("solver")
        assert first == second


def test_resumed_runs_are_those_of_one_go(tmp_path: Path) -> None:
    with Store(tmp_path / "a.sqlite") as store:
        made(store, DRAWN, 2)
    with Store(tmp_path / "a.sqlite") as store:
        resumed = made(store, DRAWN, 5)
    with Store(tmp_path / "b.sqlite") as store:
        at_once = made(store, DRAWN, 5)
    assert resumed == at_once
    assert list(resumed) == list(range(5))


def test_ctrl_c_keeps_the_finished_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    finished = some([True, False])

    def interrupted(*_: object) -> list[Row]:
        raise runs.Interrupted(finished)

    monkeypatch.setattr(runs, "simulate", interrupted)
    with Store(tmp_path / "runs.sqlite") as store:
        with pytest.raises(KeyboardInterrupt):
            made(store, DRAWN, 5)
        assert list(store.rows(DRAWN, COARSE).values()) == finished


def test_runs_of_another_build_count_only_if_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "runs.sqlite"
    with Store(path) as store:
        store.add(DRAWN, COARSE, some([True]))
    monkeypatch.setattr(c2d, "build_info", lambda: {"build_id": "another"})
    with Store(path) as store, Store(path, any_build=True) as lenient:
        assert not store.rows(DRAWN, COARSE)
        assert len(lenient.rows(DRAWN, COARSE)) == 1


def test_a_cell_with_another_height_has_runs_of_its_own(tmp_path: Path) -> None:
    with Store(tmp_path / "runs.sqlite") as store:
        store.add(DRAWN, COARSE, some([True]))
        assert store.rows(replace(DRAWN, found={"rate": 0.3}), COARSE)
        assert not store.rows(replace(DRAWN, height=0.06), COARSE)


def test_the_search_ends_where_some_runs_clear() -> None:
    found = search.bisect(lambda height: float(np.clip((0.0703 - height) / 1e-3, 0.0, 1.0)), 0, 0.3)
    assert found is not None
    height, rate = found
    assert 0.0693 < height < 0.0703
    assert search.RATES[0] <= rate <= search.RATES[1]
    assert search.bisect(lambda height: float(height < 0.07), 0.0, 0.3) is None


def test_holm_corrects_as_in_the_textbook() -> None:
    # As p.adjust(c(0.01, 0.04, 0.03, 0.005), "holm") of R.
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([0.9, 0.8]) == [1.0, 1.0]


def test_the_mean_of_equal_estimates_is_as_exact_as_their_number_makes_it() -> None:
    found = mean([Interval(0.1, 0.0, 0.3)] * 4)
    assert found == pytest.approx((0.1, 0.05, 0.2))


def test_the_intervals_of_two_looks_share_the_error() -> None:
    pairs = Pairs(100, 60, 40, 200)
    assert cell_interval(pairs, 1) == newcombe_paired(100, 60, 40, 200, 0.90)
    assert cell_interval(pairs, 2) == newcombe_paired(100, 60, 40, 200, 0.95)


def test_a_difference_at_the_bound_is_rarely_called_small() -> None:
    # Chaotic cells at a rate near a half, checked twice: at most one verdict in 20 is wrong, so of
    # 400 cells up to 30, with a probability of 99 %.
    random = np.random.default_rng(0)
    coarse = random.random((400, 1600)) < 0.5 + CELL_BOUND
    fine = random.random((400, 1600)) < 0.5
    wrong = 0
    for a, b in zip(coarse, fine, strict=True):
        for count in (400, 1600):
            first, second = a[:count], b[:count]
            both, only = int((first & second).sum()), int((first & ~second).sum())
            reference = int((~first & second).sum())
            pairs = Pairs(both, only, reference, count - both - only - reference)
            verdict = verdict_of(cell_interval(pairs, 2), CELL_BOUND)
            if verdict != "open":
                wrong += verdict == "inside"
                break
    assert wrong <= 30


def test_new_draws_count_as_chaotic_and_another_rate_does_not() -> None:
    assert Pairs(100, 100, 100, 100).is_chaotic
    assert not Pairs(200, 5, 5, 190).is_chaotic
    assert not Pairs(400, 0, 0, 0).is_chaotic
    assert not Pairs(100, 80, 0, 220).is_chaotic


def test_a_run_that_hesitates_is_behind_by_the_way_it_lost() -> None:
    (there,) = some([True])
    late = there._replace(time=there.time + 0.5, x=there.x + 0.01)
    assert path_error({0: late}, {0: there}, speed=0.4) == pytest.approx(0.19)
    stopped = late._replace(outcome="seized")
    assert np.isnan(path_error({0: stopped}, {0: stopped}, speed=0.4))


def test_only_undecided_cells_get_more_runs(tmp_path: Path) -> None:
    fine = np.arange(400) % 2 == 0
    coarse = {"inside": fine, "open": ~fine, "outside": np.full(400, True)}
    named = [replace(DRAWN, name=name) for name in coarse]
    with Store(tmp_path / "runs.sqlite") as store:
        for cell in named:
            store.add(cell, FINE, some(fine.tolist()))
            store.add(cell, COARSE, some(coarse[cell.name].tolist()))
        found = study(store, *named)
    assert [each.verdict for each in cell_verdicts(found)] == list(coarse)
    assert [cell.name for cell in undecided(found)] == ["open"]


@pytest.mark.parametrize(
    "only", [pytest.param("round", id="one"), pytest.param("", id="all", marks=pytest.mark.soak)]
)
def test_everything_is_tried_in_half_a_minute(only: str, tmp_path: Path) -> None:
    main(["--quick", "--only", only, "--store", str(tmp_path / "runs.sqlite")])
    drawn = json.loads((tmp_path / "accuracy-quick.json").read_text(encoding="utf-8"))
    page = (tmp_path / "accuracy-quick.md").read_text(encoding="utf-8")
    folder = tmp_path / "accuracy-quick"
    cells = (folder / "cells.csv").read_text(encoding="utf-8").splitlines()
    assert [line.partition(",")[0] for line in cells[1:]] == [cell["name"] for cell in drawn]
    assert all(f"| {name} |" in page for name in ("1 ms", "2 ms"))
    assert {path.name for path in folder.iterdir()} == {
        "all.svg",
        "cells.csv",
        "rates.svg",
        "paths.svg",
    }
    prose = [line for line in page.splitlines() if not line.startswith(("|", "!"))]
    assert max(map(len, prose)) <= 100
