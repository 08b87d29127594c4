"""The comparison of both engines on random robots: draws, kept results and tables."""

import dataclasses
from pathlib import Path

import pytest

import crawler2d as c2d
from benches.agreement import pairs, study
from benches.agreement.pairs import MODELS, parts, random_scenario
from benches.shared.results import read
from research.seizure import FULL
from research.tables import splice


def test_every_model_is_drawn_and_rapier_holds_it() -> None:
    for number, expected in enumerate(MODELS):
        model, scenario = random_scenario(number)
        assert model == expected
        assert random_scenario(number) == (model, scenario)
        scenario.replace({"solver": c2d.Solver(engine="rapier")}).validate()


def test_pairs_go_on_from_where_they_stopped(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[int] = []

    def make(number: int) -> dict[str, int]:
        made.append(number)
        return {"number": number}

    monkeypatch.setattr(pairs, "_pair", make)
    path = tmp_path / "pairs.json.xz"
    pairs.run(2, path)
    pairs.run(3, path)
    assert made == [0, 1, 2]
    assert [pair["number"] for pair in pairs.read_pairs(path)] == [0, 1, 2]


def test_a_pair_has_both_ends_and_both_balances(tmp_path: Path) -> None:
    path = tmp_path / "pairs.json.xz"
    pairs.run(1, path)
    (pair,) = pairs.read_pairs(path)
    assert [end["gets_over"] for end in pair["ends"]].count(True) in (0, 2)  # this is clear
    assert pair["apart"] < 1e-3 or pair["ends"][0]["gets_over"]
    table = parts([pair], {})["models"]
    assert "| line | 1 | 1 (21 to 100 %) |" in table


def test_pairs_that_differ_are_listed_one_by_one() -> None:
    end = {"outcome": "cleared", "gets_over": True, "stops": False, "penetration": 1e-4}
    stop = {"outcome": "seized", "gets_over": False, "stops": True, "penetration": 3e-4}
    pair = {
        "number": 7,
        "model": "row",
        "ends": [end, stop],
        "apart": 0.3,
        "turn": 0.1,
        "parted_at": 1.0,
        "balances": [None, True],
        "finer": {"own": "cleared", "fixed": "slipping", "rapier": "cleared"},
    }
    told = parts([pair], {"7": "cleared"})
    assert "| row | 1 | 0 (0 to 79 %) | 0 (0 to 79 %) | 0 | 0 |" in told["models"]
    last = told["unlike"].splitlines()[-1]
    assert (
        last
        == "| 7 | row | cleared | cleared | slipping | seized | cleared | cleared | yes | 0.3 |"
    )


def test_cells_of_the_study_are_in_both_engines_with_the_same_draws(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "study.json.xz"
    monkeypatch.setattr(study, "_tracks", lambda: {"line of 3": c2d.LineOfWheels(3)})
    few = dataclasses.replace(FULL, heights={"step": (0.04, 0.15), "knife edge": (0.02,)})
    monkeypatch.setattr(study, "FULL", few)
    study.study(1, path)
    study.study(1, path)  # nothing remains to do
    cells = [cell for part in read(path) for cell in part]
    assert [(cell["obstacle"], cell["height"]) for cell in cells] == [
        ("step", 0.04),
        ("step", 0.15),
        ("knife edge", 0.02),
    ]
    last = study.study_table(read(path)).splitlines()[-1]
    assert last.startswith("| all | 3 | 3 | ")


def test_the_page_has_the_table_of_the_results() -> None:
    page = (Path(__file__).parents[2] / "docs" / "studies" / "agreement.md").read_text("utf-8")
    assert "<!-- end of study -->" in page
    table = study.study_table(read(pairs.RESULTS / "study.json.xz"))
    assert splice(page, {"study": table}) == page


def test_rapier_holds_rows_gears_and_wheels_all_round_of_the_study() -> None:
    held = study._tracks()
    assert {"line of 3", "line of 5 gears", "24 all round", "24 gears all round"} <= set(held)
    assert "belt" not in held


def test_six_solvers_meet_the_knife_edge_from_the_same_starts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("pymunk")
    path = tmp_path / "pinched.json.xz"
    monkeypatch.setattr(study, "_HEIGHTS", (0.002,))
    monkeypatch.setattr(study, "_SPEEDS", (0.4,))
    study.pinched(1, path)
    last = study.pinched_table(read(path)).splitlines()[-1]
    assert last == "| 2 | 0.4 |" + 6 * " 1 of 1 |"
