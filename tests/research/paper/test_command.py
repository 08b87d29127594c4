"""The command: its files, store and output."""

import csv
import re
from dataclasses import replace
from pathlib import Path

import pytest

import crawler2d as c2d
from crawler2d.sweeps.store import Store
from research import paper
from research.__main__ import main
from research.paper import command, performance, table_2
from research.paper.design import FULL, QUICK, SETTINGS
from research.paper.figures import DRAWINGS

TINY = replace(
    QUICK,
    field_repeats=1,
    field_layouts=("line of 3", "belt"),
    heights=(0.06, 0.20),
    height_repeats=1,
    driving_repeats=1,
    slope_repeats=1,
    computing_repeats=1,
)


@pytest.fixture(autouse=True)
def _tiny(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make a quick run tiny, with two of three settings and the two fastest layouts."""
    monkeypatch.setattr(command, "QUICK", TINY)
    monkeypatch.setattr(table_2, "SETTINGS", SETTINGS[:2])
    whole = performance.ROWS
    fast = {row: whole[row] for row in (paper.CWA_ROUND, paper.LWA_ROUND)}
    fast[paper.REAL_ROBOT] = "belt"
    monkeypatch.setattr(performance, "ROWS", fast)


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_tables_and_pictures_come_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    page = tmp_path / "pages" / "page.md"
    page.parent.mkdir()
    page.write_text("![](paper_table_2.png)\n\n<!-- table 2 -->\n<!-- end of table 2 -->\n")
    asked = [*("--table", "2"), *("--table", "3"), *("--table", "figures")]
    arguments = ["paper", "--out", str(tmp_path), "--threads", "1", *asked]
    assert main([*arguments, "--into", str(page)]) == 0
    printed = capsys.readouterr().out
    text = (tmp_path / "paper.md").read_text(encoding="utf-8")
    assert set(text.splitlines()) <= set(printed.splitlines())
    assert "min of processor time" in printed
    assert "A quick run" in text
    assert re.search(r"Tried in all: \d+ runs in \d+ cells", text)
    sections = [line for line in text.splitlines() if line.startswith("## ")]
    assert sections == [
        f"## {name}"
        for name in (
            *("Table 2", "All layouts", "Failures", "Table 1", "Table 3"),
            *("Highest obstacles", "Real-time factors", "Figures"),
        )
    ]

    found = rows(tmp_path / "paper_table_2.csv")
    assert len(found) == 2 * 3 * len(TINY.field_layouts)  # settings, fields
    failed = rows(tmp_path / "paper_failures.csv")
    assert len(failed) == sum(int(row["count"]) - int(row["cleared"]) for row in found)
    beside = rows(tmp_path / "paper_table_2_beside.csv")
    assert {row["model"] for row in beside} == {"line of 3"}
    assert "| random RSE | line of 3 | 15 |" in text
    assert "| line of 3 | Fig. 3 |" in text
    assert "arc tangent" in text
    (belt,) = (row for row in rows(tmp_path / "paper_driving.csv") if row["model"] == "belt")
    assert float(belt["speed"]) == pytest.approx(0.4)
    assert float(belt["braking"]) == pytest.approx(0.02, rel=1e-3)
    for name in ("table_2", "layouts", "stuck"):
        assert (tmp_path / f"paper_{name}.png").stat().st_size > 10_000
    assert {each.name for each in page.parent.iterdir()} == {"page.md", "paper_table_2.png"}
    for number in (4, 5):
        assert (tmp_path / "replays_paper" / f"figure_{number}.html").stat().st_size > 10_000
        assert f"Fig. {number}, " in text
    assert all(f"| {drawn.number} | {drawn.caption} | drawn |" in text for drawn in DRAWINGS)
    page_text = page.read_text()
    assert page_text.startswith("![](paper_table_2.png)\n\n<!-- table 2 -->\n\nCells: ")
    assert page_text.endswith("\n\n<!-- end of table 2 -->\n")

    # The store has every run, so nothing is simulated again. Pictures take longest.
    monkeypatch.setattr(command.Pages, "draw", lambda *_, **__: None)
    assert main([*arguments[:-6], "--table", "2"]) == 0
    again = capsys.readouterr().out
    for line in text.partition("## Table 1")[0].partition("## Table 2")[2].splitlines():
        assert line in again


def test_ctrl_c_ends_it_with_its_own_exit_code(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(*_: object) -> object:
        raise c2d.BatchInterrupted([])

    monkeypatch.setattr(table_2, "cross_fields", interrupted)
    assert main(["paper", "--out", str(tmp_path)]) == 130
    assert "Traceback" not in capsys.readouterr().err
    # Earlier results are there.
    assert "## Chosen beforehand" in (tmp_path / "paper.md").read_text(encoding="utf-8")


def test_a_store_in_use_is_an_error_of_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with Store(tmp_path / "paper.sqlite"):
        assert main(["paper", "--out", str(tmp_path), "--table", "2"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("python -m research paper: ")
    assert "is being written" in line


def test_the_full_design_repeats_more_than_the_paper() -> None:
    assert FULL.field_repeats == 100
    assert FULL.field_layouts == ()
    for design in (FULL, QUICK, TINY):
        assert {paper.TABLE_1.max_slope, paper.TABLE_1.declared_max_slope} <= set(design.angles)
