"""The chart of drives: files that its command writes and stores."""

import contextlib
import csv
import io
import shutil
from collections.abc import Sequence
from pathlib import Path

import pytest

import crawler2d as c2d
from research import study
from research.__main__ import main
from research.paper import chart
from research.paper.chart import TABLES, DriveCell, Drives, real_inertias
from research.paper.command import STORE
from research.paper.design import PRESET
from research.paper.table_2 import COLUMNS

# Too weak to reach a field: it ends soon, and the paper's table excludes it.
TINY = (
    *("--torques", "0.05", "0.1", "--inertias", "0", "--frictions", "0.5"),
    *("--runs", "2", "2", "1", "1", "--threads", "1"),
)


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def charted(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """Files and output of the command."""
    folder = tmp_path_factory.mktemp("chart")
    page = folder / "page.md"
    page.write_text("Ours:\n\n<!-- drives -->\n<!-- end of drives -->\n")
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        assert main(["chart", "--out", str(folder), *TINY, "--into", str(page)]) == 0
    return folder, printed.getvalue()


def test_chart_tables_and_page_come_out(charted: tuple[Path, str]) -> None:
    folder, printed = charted
    found = rows(folder / "paper_drives.csv")
    assert len(found) == 2 * 4 * 3  # drives, layouts, fields
    counts = {row["model"]: row["count"] for row in found}
    assert counts == dict(zip(COLUMNS, "2211", strict=True))
    assert {row["cleared"] for row in found} == {"0"}
    joint = rows(folder / "paper_drives_joint.csv")
    assert {row["reading"] for row in joint} == {"large gears", "small gears"}
    assert all(float(row["probability"]) < 0.05 for row in joint)
    assert (folder / "paper_drives.png").stat().st_size > 10_000
    text = (folder / "page.md").read_text()
    assert "36 runs, of 2 drives at frictions of 0.5; runs a cell: " in text
    assert "| 0.5 | large gears | 0 of 2 |" in text
    assert all(line in printed for line in text.splitlines() if line.startswith("| 0.5"))


def test_drives_that_remain_are_tried_more_often(
    charted: tuple[Path, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copy(charted[0] / STORE, tmp_path)  # the common runs

    def first_reading(rows: Sequence[DriveCell]) -> set[str]:
        return {model for _, model in TABLES["large gears"]} if rows[0].torque == 0.1 else set()

    monkeypatch.setattr(chart, "layouts_left", first_reading)
    monkeypatch.setattr(study.Job, "draw", lambda *_, **__: None)
    assert main(["chart", "--out", str(tmp_path), *TINY, "--most", "3"]) == 0
    counts = {(row["torque"], row["count"]) for row in rows(tmp_path / "paper_drives.csv")}
    assert counts == {*(("0.05", each) for each in "21"), *(("0.1", each) for each in "31")}


def test_ctrl_c_ends_it_with_its_own_exit_code(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(*_: object) -> object:
        raise c2d.BatchInterrupted([])

    monkeypatch.setattr(chart, "drive_cells", interrupted)
    assert main(["chart", "--out", str(tmp_path)]) == 130
    assert "Traceback" not in capsys.readouterr().err


def test_a_drive_has_the_rotor_that_is_asked_for_or_the_robots() -> None:
    robot = c2d.robots.engineer()
    (setting,) = Drives(
        torques=(8.0,), inertias=(0.1,), frictions=(0.5,), runs=(1, 1, 1, 1), most=1
    ).settings()
    driven = setting.on(robot).drivetrain
    assert (driven.max_torque, driven.rotor_inertia, driven.torque_sharing) == (8.0, 0.1, "track")
    assert PRESET.on(robot).drivetrain.rotor_inertia == robot.drivetrain.rotor_inertia


def test_a_plausible_rotor_follows_from_run_up_time_torque_and_speed() -> None:
    # Belt radius 52 mm; 6 N m in 0.016 s to 1.39 m/s, 12 N m in 0.1 s to 0.4 m/s.
    assert real_inertias() == pytest.approx((0.016 * 6.0 * 0.052 / 1.39, 0.1 * 12.0 * 0.052 / 0.4))
