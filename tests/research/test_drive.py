"""Effects of drives: the search for the highest edge, with a few runs."""

import csv
from pathlib import Path

import pytest

from research import drive
from research.__main__ import main
from research.drive import (
    FIRM,
    INERTIAS,
    HighestEdge,
    Plan,
    cases,
    design,
    highest_edges,
    highest_edges_text,
    other_cases,
    paired_text,
    plot_drive,
)

FEW = Plan(repeats=2, progress=False)
KNIFE = cases(("line of 5",), ("knife edge",), (0.4,), (0.0, 0.1))


@pytest.fixture(scope="module")
def found() -> list[HighestEdge]:
    return highest_edges(KNIFE, FEW)


def test_a_rotor_carries_the_line_of_five_over_a_higher_knife_edge(
    found: list[HighestEdge],
) -> None:
    without, with_rotor, firm = found
    assert [row.drive for row in found] == ["0", "0.1", FIRM]
    assert without.height <= with_rotor.height <= firm.height
    assert (without.higher, without.lower) == (0, 0)
    assert (with_rotor.higher, with_rotor.lower) == (2, 0)
    for row in found:
        assert row.low <= row.height <= row.high
        assert len(row.heights) == FEW.repeats


def test_where_the_search_starts_does_not_matter(found: list[HighestEdge]) -> None:
    (case,) = KNIFE
    turned = case._replace(drives=dict(reversed(list(case.drives.items()))))
    heights = {row.drive: row.heights for row in highest_edges([turned], FEW)}
    assert heights == {row.drive: row.heights for row in found}


def test_runs_are_kept_in_the_store(tmp_path: Path, found: list[HighestEdge]) -> None:
    plan = Plan(repeats=2, store=tmp_path / "runs.sqlite", progress=False)
    assert highest_edges(KNIFE, plan) == found
    size = plan.store.stat().st_size if plan.store else 0
    assert highest_edges(KNIFE, plan) == found
    assert plan.store is not None
    assert plan.store.stat().st_size == size


def test_every_model_has_every_drive_but_force_no_firm_motor() -> None:
    asked = design()
    assert len({case.model for case in asked}) == 10
    assert len(asked) == 7 * 2 * 3 + 3 * 2
    for case in asked:
        firm = [] if case.model.startswith("force") else [FIRM]
        assert list(case.drives)[-1:] == (firm or ["0.5"])
        inertias = [drive.rotor_inertia for drive in case.drives.values()]
        assert inertias[: len(inertias) - len(firm)] in ([*INERTIAS], [0.0, 0.04, 0.5])
    for case in other_cases():
        inertias = [drive.rotor_inertia for drive in case.drives.values()]
        assert inertias == [0.0] * 6 + [0.04] * 6


def test_the_texts_have_a_row_a_case_and_a_row_a_drive(found: list[HighestEdge]) -> None:
    head, _, line = highest_edges_text(found).splitlines()
    assert head.split()[-3:] == ["0", "0.1", FIRM]
    assert line.startswith("line of 5")
    assert line.count(" to ") == 3
    _, _, *lines = paired_text(found).splitlines()
    assert lines[0].split() == ["0.1", "2", "2", "0", "0"]


def test_the_picture_has_a_panel_an_obstacle_and_speed(found: list[HighestEdge]) -> None:
    (panel,) = plot_drive(found).axes
    assert panel.get_title() == "knife edge, 0.4 m/s"
    assert [text.get_text() for text in panel.get_xticklabels()] == ["0", "0.1", FIRM]
    assert "[mm]" in panel.get_ylabel()


def test_it_writes_its_tables_and_its_picture(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(drive, "other_cases", lambda: KNIFE)
    assert main(["drive", "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    with (tmp_path / "drive.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["obstacle"] for row in rows} == {"step", "knife edge"}
    for line in (tmp_path / "drive.txt").read_text(encoding="utf-8").splitlines():
        assert line in printed
    assert (tmp_path / "drive.png").stat().st_size > 10_000
    assert (tmp_path / "drive.sqlite").exists()
