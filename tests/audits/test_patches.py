"""A file that seizes is read, audited, changed, and read and audited again without seizures."""

import html
import json
import re
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d.__main__ import main
from crawler2d.audits.patches import best_change
from crawler2d.errors import ScenarioWarning
from tests.audits.seizing import QUIET, SAID, SEIZING, STEP
from tests.kept import refusing
from tests.reading.carts import quietly

# In a file each wheel has its own motor; with the preset's torque one of them would stall.
STRONG = replace(SEIZING, drivetrain=replace(SEIZING.drivetrain, max_torque=60.0))


@pytest.fixture(
    scope="module", params=["sdf", "urdf", pytest.param("mjcf", marks=pytest.mark.soak)]
)
def audited(request: Any, tmp_path_factory: Any) -> c2d.Audit:
    """Four touching wheels as a file, on a step of 75 mm, with only the start unknown."""
    path = tmp_path_factory.mktemp("model") / f"robot.{request.param}"
    getattr(STRONG, f"to_{request.param}")(path, friction=0.9)
    return c2d.audit(path, STEP, unknown={}, repeats=20, quick=True, engine="gz", **QUIET)


def test_the_changed_file_clears_the_obstacle_on_which_the_file_seized(
    audited: c2d.Audit, tmp_path: Path
) -> None:
    assert audited.seizes
    assert audited.reading is not None
    path = tmp_path / audited.reading.path.name
    diff = audited.patch(path)
    assert diff.startswith(f"--- {path.name}\n+++ ")
    again = c2d.audit(path, STEP, unknown={}, repeats=20, seed=1, quick=True, engine="gz", **QUIET)
    assert again.verdicts[0].cleared.rate >= 0.95
    assert not again.seizes
    assert len(again.robot.wheels()) == 2 * audited.repairs[0].wheels


def test_a_robot_that_was_no_file_is_refused() -> None:
    alone = c2d.audit(STRONG, STEP, unknown={}, repeats=2, repair=False, **QUIET)
    with refusing(SAID, "must be the audit of a file"):
        alone.patch()


@pytest.mark.parametrize("repair", ["chassis: 5 wheels in place of 4", 0])
def test_anything_but_a_repair_is_refused(audited: c2d.Audit, repair: Any) -> None:
    with refusing(SAID, "^repair must be one of the repairs"):
        audited.patch(repair=repair)


def test_belts_are_written_anew_by_name(audited: c2d.Audit, tmp_path: Path) -> None:
    (belt,) = (each for each in audited.repairs if each.kind == "belt")
    assert audited.reading is not None
    path = tmp_path / audited.reading.path.name
    is_urdf = path.suffix == ".urdf"
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        assert audited.patch(path, repair=belt) == ""
    assert ["because URDF holds no belts" in str(each.message) for each in caught] == [
        True
    ] * is_urdf
    written = path.with_suffix(".sdf") if is_urdf else path
    assert isinstance(quietly(written).robot.track, c2d.BeltTrack)
    assert "<!-- crawler2d, confirmed: belts moved by a track plugin" in written.read_text()


def test_without_a_confirmed_repair_belts_are_written(tmp_path: Path) -> None:
    path = tmp_path / "robot.sdf"
    STRONG.to_sdf(path, friction=0.9)
    found = c2d.audit(path, STEP, unknown={}, repeats=9, repair=False, **QUIET)
    assert found.seizes
    assert found.repairs == ()
    new = tmp_path / "new.sdf"
    assert found.patch(new) == ""
    assert isinstance(quietly(new).robot.track, c2d.BeltTrack)
    label = "not confirmed: belts moved by a track plugin (BeltTrack, along the outline); the belt"
    assert label in new.read_text(encoding="utf-8")


@pytest.fixture
def helped(audited: c2d.Audit) -> c2d.Audit:
    """An audit with unconfirmed wheels that seize in a fifth of the runs."""
    assert audited.repaired is not None
    best, *others = audited.repairs
    assert best.kind == "wheels"
    seldom = {name: replace(each, rate=0.2) for name, each in best.seized.items()}
    unsure = replace(best, confirmed=False, seized=seldom)
    kept = tuple(each for each in others if each.kind == "belt")
    return replace(audited, repaired=audited.repaired._replace(repairs=(*kept, unsure)))


def test_wheels_that_help_are_written_before_belts(helped: c2d.Audit, tmp_path: Path) -> None:
    assert helped.reading is not None
    new = tmp_path / helped.reading.path.name
    assert "+++" in helped.patch(new)
    assert len(quietly(new).robot.wheels()) == 2 * helped.repairs[-1].wheels
    text = new.read_text(encoding="utf-8")
    assert "<!-- crawler2d, not confirmed: chassis: 5 wheels in place of 4; clears" in text


def test_wheels_that_do_not_help_are_not_written(helped: c2d.Audit) -> None:
    assert helped.repaired is not None
    *others, wheels = helped.repairs
    always = {name: replace(each, rate=1.0) for name, each in wheels.seized.items()}
    repairs = (*others, replace(wheels, seized=always))
    change = best_change(replace(helped, repaired=helped.repaired._replace(repairs=repairs)))
    assert change is not None
    assert change.label.startswith("confirmed: belts moved by a track plugin")


def test_of_confirmed_wheels_the_first_are_written_even_if_others_seize_less(
    audited: c2d.Audit,
) -> None:
    assert audited.repaired is not None
    first = audited.repairs[0]
    assert first.kind == "wheels"
    assert first.confirmed
    seldom = {name: replace(each, rate=0.04) for name, each in first.seized.items()}
    six = audited.robot.with_track(c2d.LineOfWheels(6, wheel_radius=0.0608))
    repairs = (replace(first, seized=seldom), replace(first, description="six wheels", robot=six))
    change = best_change(replace(audited, repaired=audited.repaired._replace(repairs=repairs)))
    assert change is not None
    assert change.label.startswith(f"confirmed: {first.description};")


def test_a_robot_that_can_be_written_neither_on_wheels_nor_on_belts_is_refused_with_both_reasons(
    helped: c2d.Audit,
) -> None:
    assert helped.repaired is not None
    *others, wheels = helped.repairs
    repairs = (*others, replace(wheels, robot=helped.robot))  # whose wheels the file has
    repaired = helped.repaired._replace(repairs=repairs)
    light = replace(helped.belt.robot, moment_of_inertia=0.01)  # less than that of its belts
    with refusing(SAID) as caught:
        replace(helped, repaired=repaired, belt=helped.belt._replace(robot=light)).patch()
    assert caught.value.path == "repair"
    assert caught.value.rule.startswith(
        f"must be one that can be written to a file: {wheels.description}: robot.track must have"
        " wheels that differ from the file's, got"
    )
    assert "; belts: robot.moment_of_inertia must" in caught.value.rule


def test_a_file_that_does_not_seize_is_not_changed(
    tmp_path: Path, capsys: Any, monkeypatch: Any
) -> None:
    from crawler2d.commands import audit as command  # noqa: PLC0415 - to replace what it calls

    path, new = tmp_path / "robot.urdf", tmp_path / "new.urdf"
    STRONG.with_track(c2d.LineOfWheels(5, wheel_radius=0.0608)).to_urdf(path, friction=0.9)
    found = c2d.audit(path, STEP, unknown={}, repeats=9, engine="gz", **QUIET)
    assert found.patch(new) == ""
    monkeypatch.setattr(command, "audit", lambda *_, **__: found)
    assert main(["audit", "any.sdf", "--no-html", "--patch", str(new)]) == 0
    assert "It does not seize: no changed file is written" in capsys.readouterr().out
    assert not new.exists()


def test_the_command_writes_the_changed_file(
    audited: c2d.Audit, capsys: Any, monkeypatch: Any, tmp_path: Path
) -> None:
    from crawler2d.commands import audit as command  # noqa: PLC0415 - to replace what it calls

    monkeypatch.setattr(command, "audit", lambda *_, **__: audited)
    path = tmp_path / "new"
    assert main(["audit", "any.sdf", "--no-html", "--patch", str(path)]) == 1
    printed = capsys.readouterr()
    assert f"The changed file is {path}" in printed.out
    label, summary, _ = printed.out.strip().splitlines()
    assert label.startswith("confirmed: chassis: 5 wheels in place of 4")
    assert re.fullmatch(r"wheels: .*2 added.*; lines: \d+ new, \d+ gone", summary)
    assert "+++" not in printed.out
    assert main(["audit", "any.sdf", "--no-html", "--json", "--patch", str(path)]) == 1
    assert json.loads(capsys.readouterr().out)["seizes"]
    assert audited.reading is not None
    assert quietly(path.rename(tmp_path / audited.reading.path.name)).robot.track != SEIZING.track


def test_belts_of_urdf_are_written_as_sdf_beside_it(
    capsys: Any, monkeypatch: Any, tmp_path: Path
) -> None:
    from crawler2d.commands import audit as command  # noqa: PLC0415 - to replace what it calls

    source, path = tmp_path / "robot.urdf", tmp_path / "new.urdf"
    STRONG.to_urdf(source, friction=0.9)
    found = c2d.audit(source, STEP, unknown={}, repeats=10, repair=False, engine="gz", **QUIET)
    monkeypatch.setattr(command, "audit", lambda *_, **__: found)
    assert main(["audit", "any.sdf", "--no-html", "--patch", str(path)]) == 1
    printed = capsys.readouterr().out
    assert "a new SDF file, because URDF holds no belts" in printed
    assert f"The changed file is {tmp_path / 'new.sdf'}" in printed
    assert (tmp_path / "new.sdf").exists()
    assert not path.exists()


def test_the_page_has_the_diff_of_each_repair_by_wheels(audited: c2d.Audit) -> None:
    page = audited.to_html()
    diffs = [audited.patch(repair=each) for each in audited.repairs if each.kind != "belt"]
    assert diffs
    for diff in diffs:
        assert len(diff.splitlines()) > 20
        assert html.escape(diff.strip()) in page


def test_a_changed_file_warns_of_nothing_that_is_in_the_lint(tmp_path: Path) -> None:
    """Warnings are errors in tests."""
    slow = replace(STRONG, moment_of_inertia=6.0)
    with pytest.warns(ScenarioWarning, match="moment_of_inertia"):
        slow.to_urdf(tmp_path / "slow.urdf", friction=0.9)
    how: Any = {"unknown": {}, "repeats": 9, "quick": True, "engine": "gz", **QUIET}
    found = c2d.audit(tmp_path / "slow.urdf", STEP, **how)
    assert any("moment_of_inertia" in each.message for each in found.lint)
    assert best_change(found) is not None
    assert "+++" in found.patch(repair=found.repairs[0])
    assert "+++" in found.to_html()
