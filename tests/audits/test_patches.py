"""From a file that seizes to one that does not: read, audited, changed, read and audited again."""

import html
import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d.__main__ import main
from tests.audits.seizing import QUIET, SEIZING, STEP
from tests.reading.carts import quietly

# In a file each wheel has a motor of its own; with the preset's torque one of them would stall.
STRONG = replace(SEIZING, drivetrain=replace(SEIZING.drivetrain, max_torque=60.0))


@pytest.fixture(scope="module", params=["sdf", "urdf", "mjcf"])
def audited(request: Any, tmp_path_factory: Any) -> c2d.Audit:
    """Four touching wheels as a file, on a step of 75 mm, everything known but the start."""
    path = tmp_path_factory.mktemp("model") / f"robot.{request.param}"
    getattr(STRONG, f"to_{request.param}")(path, friction=0.9)
    return c2d.audit(path, STEP, unknown={}, repeats=20, engine="gz", **QUIET)


def test_the_changed_file_gets_over_where_the_file_seized(
    audited: c2d.Audit, tmp_path: Path
) -> None:
    assert audited.seizes
    assert audited.reading is not None
    path = tmp_path / audited.reading.path.name
    diff = audited.patch(path)
    assert diff.startswith(f"--- {path.name}\n+++ ")
    again = c2d.audit(path, STEP, unknown={}, repeats=20, seed=1, engine="gz", **QUIET)
    assert again.verdicts[0].cleared.rate >= 0.95
    assert not again.seizes
    assert len(again.robot.wheels()) == 2 * audited.repairs[0].wheels


def test_belts_and_robots_that_were_no_file_are_refused(audited: c2d.Audit) -> None:
    (belt,) = (each for each in audited.repairs if each.kind == "belt")
    with pytest.raises(c2d.ScenarioError, match=r"write belts with repair\.robot\.to_sdf"):
        audited.patch(repair=belt)
    alone = c2d.audit(STRONG, STEP, unknown={}, repeats=2, repair=False, **QUIET)
    with pytest.raises(c2d.ScenarioError, match="must be the audit of a file"):
        alone.patch()


def test_without_a_confirmed_repair_there_is_no_patch(tmp_path: Path) -> None:
    path = tmp_path / "robot.urdf"
    STRONG.to_urdf(path, friction=0.9)
    found = c2d.audit(path, STEP, unknown={}, repeats=2, repair=False, **QUIET)
    with pytest.raises(c2d.ScenarioError, match="got none that is confirmed"):
        found.patch(tmp_path / "new.urdf")
    assert not (tmp_path / "new.urdf").exists()


def test_the_command_writes_the_changed_file(
    audited: c2d.Audit, capsys: Any, monkeypatch: Any, tmp_path: Path
) -> None:
    from crawler2d.reports import audit as command  # noqa: PLC0415 - to replace what it calls

    monkeypatch.setattr(command, "audit", lambda *_, **__: audited)
    path = tmp_path / "new"
    assert main(["audit", "any.sdf", "--no-html", "--patch", str(path)]) == 1
    printed = capsys.readouterr()
    assert printed.out.startswith(audited.in_words)
    assert f"The changed file is {path}" in printed.out
    summary = printed.out[len(audited.in_words) :].strip().splitlines()[0]
    assert re.fullmatch(r"wheels: .*2 added.*; lines: \d+ new, \d+ gone", summary)
    assert "+++" not in printed.out
    assert main(["audit", "any.sdf", "--no-html", "--json", "--patch", str(path)]) == 1
    assert json.loads(capsys.readouterr().out)["seizes"]
    assert audited.reading is not None
    assert quietly(path.rename(tmp_path / audited.reading.path.name)).robot.track != SEIZING.track


def test_the_command_says_why_there_is_no_changed_file(
    capsys: Any, monkeypatch: Any, tmp_path: Path
) -> None:
    from crawler2d.reports import audit as command  # noqa: PLC0415 - to replace what it calls

    source, path = tmp_path / "robot.urdf", tmp_path / "new.urdf"
    STRONG.to_urdf(source, friction=0.9)
    found = c2d.audit(source, STEP, unknown={}, repeats=10, repair=False, engine="gz", **QUIET)
    monkeypatch.setattr(command, "audit", lambda *_, **__: found)
    assert main(["audit", "any.sdf", "--no-html", "--patch", str(path)]) == 1
    assert "No changed file: repair must be" in capsys.readouterr().err
    assert not path.exists()


def test_the_page_has_the_diff_of_each_repair_by_wheels(audited: c2d.Audit) -> None:
    page = audited.to_html()
    for repair in audited.repairs:
        if repair.kind != "belt":
            assert html.escape(audited.patch(repair=repair).splitlines()[3]) in page
