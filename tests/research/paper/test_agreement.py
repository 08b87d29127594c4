"""Agreement of our rates with the paper's, and its reports."""

import pytest

import crawler2d as c2d
from crawler2d.sweeps.statistics import newcombe
from research.paper import (
    CWA_ROUND,
    GEAR_MODEL,
    GEAR_MODEL_OTHERWISE,
    LWA_ROUND,
    PAPER_RUNS,
    TABLE_2,
    agreement,
)
from research.paper.claims import Check, Claim, check_clears, check_fewer
from research.paper.table_2 import COLUMNS, FieldCell, compare, table_2_text
from research.tables import markdown_table, splice


@pytest.mark.parametrize(
    ("cleared", "count", "share", "verdict"),
    [
        (0, 100, 0.0, "agrees"),
        (30, 100, 0.15, "agrees"),  # 0.15 apart
        (31, 100, 0.15, "open"),
        (85, 100, 1.0, "agrees"),
        (84, 100, 1.0, "open"),  # the paper's 20 of 20 allow it
        (75, 100, 1.0, "differs"),
        (0, 100, 0.4, "differs"),
        (3, 5, 0.4, "open"),
    ],
)
def test_rates_agree_within_15_points(cleared: int, count: int, share: float, verdict: str) -> None:
    found = agreement(cleared, count, share)
    assert found.verdict == verdict
    assert (found.difference, found.low, found.high) == newcombe(
        cleared, count, round(share * PAPER_RUNS), PAPER_RUNS
    )


def test_rates_of_the_paper_are_of_20_runs() -> None:
    with pytest.raises(ValueError, match="whole number of 20 runs"):
        agreement(1, 10, 0.33)


def cell(model: str, cleared: int) -> FieldCell:
    rate, low, high = c2d.wilson(cleared, 100)
    return FieldCell(
        setting="preset",
        obstacle="horizontal barrier",
        model=model,
        column=COLUMNS.get(model, ""),
        cleared=cleared,
        count=100,
        rate=rate,
        low=low,
        high=high,
        others="",
        computing_time=1.0,
    )


def test_each_column_of_table_2_stands_beside_its_layout() -> None:
    row = next(row for row in TABLE_2 if row.obstacle == "horizontal barrier")
    found = compare([cell(model, 10) for model in (*COLUMNS, "belt")])
    papers = {each.column: each.paper for each in found}
    assert papers == {
        CWA_ROUND: row.cwa,
        LWA_ROUND: row.lwa,
        GEAR_MODEL: row.gear,
        GEAR_MODEL_OTHERWISE: row.gear,
    }
    verdicts = {each.column: each.verdict for each in found}
    assert verdicts[LWA_ROUND] == "agrees"
    assert verdicts[GEAR_MODEL] == "differs"
    text = table_2_text(found)
    assert "| 10 | 10 of 100; +0 (-21 to +10): **agrees** |" in text
    assert "10 of 100; -90 (-94 to -72): **differs**" in text


def test_a_claim_holds_in_part_if_some_of_its_checks_do() -> None:
    gears = check_clears("gears clear", [("three", 18, 20), ("five", 20, 20)])
    knife = check_clears("gears clear a knife", [("five", 17, 20)])
    assert (gears.holds, knife.holds) == (True, False)
    assert check_clears("stays", [("three", 2, 20)], never=True).holds
    assert Claim(section="3", text="", experiment="", checks=(gears, knife)).verdict == (
        "holds in part"
    )


def test_few_runs_do_not_show_that_heavy_robots_stick_more() -> None:
    def check(heavy: int, light: int, count: int) -> Check:
        return check_fewer("sticks more", ("heavy", heavy, count), ("light", light, count))

    assert check(1, 2, 5).holds is None
    assert check(20, 40, 100).holds is True
    assert check(2, 2, 5).holds is False
    claim = Claim(section="2.2", text="", experiment="", checks=(check(1, 2, 5),))
    assert claim.verdict == "not shown"


def test_tables_go_between_their_marks_and_nowhere_else() -> None:
    page = "a\n\n<!-- one -->\n<!-- end of one -->\n\nb\n"
    table = markdown_table(("x", "y"), [("1", r"\1")])  # text that looks like a group is unchanged
    once = splice(page, {"one": table, "two": "nowhere"})
    assert once == f"a\n\n<!-- one -->\n\n{table}\n\n<!-- end of one -->\n\nb\n"
    assert splice(once, {"one": table}) == once
