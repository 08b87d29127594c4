"""New issues since a baseline fail; verdicts that flip near a bound and moved lines do not."""

import dataclasses
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d.audits.baseline import compare, entry_of, read_baseline, write_baseline
from crawler2d.audits.issues import Check, check_of
from crawler2d.audits.lint import Finding
from crawler2d.audits.verdicts import Proportion, Verdict
from crawler2d.sweeps.statistics import wilson
from tests.audits.seizing import SAID
from tests.kept import refusing

Made = Callable[..., Check]


def share(hits: int, runs: int = 80) -> Proportion:
    _, low, high = wilson(hits, runs)
    rate = hits / runs
    return Proportion(
        rate=rate,
        low=low,
        high=high,
        band_low=rate,
        band_median=rate,
        band_high=rate,
        runs=runs,
        samples=runs,
    )


@pytest.fixture
def made(of_file: c2d.Audit) -> Made:
    """Makes checks with given verdicts and lint, and otherwise those of a cart."""
    seizing = of_file.verdicts[0]

    def verdict(label: str, word: str, hits: int, *at: tuple[int, int]) -> Verdict:
        return dataclasses.replace(
            seizing,
            obstacle=label,
            result=word,
            seized=share(hits),
            seized_at={0.1 * k: share(*each) for k, each in enumerate(at, 1)},
        )

    def make(*verdicts: Any, lint: tuple[Finding, ...] = (), **changed: Any) -> Check:
        assert of_file.reading is not None
        robot = dataclasses.replace(of_file.robot, **changed)
        found = dataclasses.replace(
            of_file, robot=robot, lint=lint, verdicts=tuple(verdict(*each) for each in verdicts)
        )
        return check_of(of_file.reading.path, found)

    return make


def compared(before: Check, now: Check, folder: Path) -> tuple[list[str], str]:
    """New issues, by rule and obstacle, and changes in words."""
    path = folder / "audit.json"
    write_baseline(path, [before], None)
    check, changes = compare(now, read_baseline(path), path)
    return [issue.obstacle or issue.rule for issue in check.failing], "\n".join(changes)


@pytest.mark.parametrize(
    ("before", "now", "is_new"),
    [
        # as before, and a little more often
        (("seizes", 10), ("seizes", 10), False),
        (("seizes", 10), ("seizes", 16), False),
        # without this note: equal builds give equal runs
        (("not certain", 7), ("seizes", 9), True),
        (("belt fails, too", 8), ("seizes", 9), True),
        # far more often
        (("seizes", 10), ("seizes", 40), True),
        (("belt fails, too", 5), ("seizes", 40), True),
        (("not certain", 5), ("seizes", 20), True),
        # said not to
        (("does not seize", 1), ("seizes", 9), True),
        # the absence of seizures is never new
        (("does not seize", 0), ("not certain", 7), False),
        (("does not seize", 0), ("belt fails, too", 40), False),
    ],
)
def test_a_seizure_is_new_by_its_interval_or_after_another_verdict(
    made: Made, tmp_path: Path, before: Any, now: Any, is_new: bool
) -> None:
    new, changes = compared(made(("step 30 mm", *before)), made(("step 30 mm", *now)), tmp_path)
    assert new == ["step 30 mm"] * is_new
    assert ("this is new" in changes) is is_new
    moved = before[0] != now[0] or is_new
    assert (f"step 30 mm: {before[0]} is now {now[0]}" in changes) is moved


@pytest.mark.parametrize(
    ("before", "now", "is_new"),
    [
        (("not certain", 7), ("seizes", 9), False),
        (("belt fails, too", 8), ("seizes", 9), False),
        (("belt fails, too", 5), ("seizes", 40), True),
        (("does not seize", 1), ("seizes", 9), True),
    ],
)
def test_with_another_build_a_rate_near_a_bound_may_change_its_verdict(
    made: Made, before: Any, now: Any, is_new: bool
) -> None:
    kept = {**entry_of(made(("step 30 mm", *before))), "build": "another"}
    check = made(("step 30 mm", *now))
    name = check.path.name
    baseline = {"baseline": 1, "models": {name: kept}}
    check, changes = compare(check, baseline, check.path.with_name("audit.json"))
    assert [issue.obstacle for issue in check.failing] == ["step 30 mm"] * is_new
    assert any("another build" in line for line in changes) is not is_new
    assert any("(another) is now" in line for line in changes)


def test_places_are_kept_from_the_root_of_the_repository(tmp_path: Path, made: Made) -> None:
    def changes(root: Path) -> list[Any]:
        (root / ".git").mkdir(parents=True)
        what = f"is taken to be {root}/urdf/utils.xacro: no package has that name"
        finding = Finding(rule="other", severity="warning", message=what)
        check = dataclasses.replace(made(lint=(finding,)), path=root / "robot" / "cart.sdf")
        return list(entry_of(check)["lint"])

    assert changes(tmp_path / "here") == changes(tmp_path / "there" / "deeper")


def test_a_seizure_at_one_speed_alone_is_new(made: Made, tmp_path: Path) -> None:
    before = made(("step 30 mm", "seizes", 4, (4, 27), (0, 27), (0, 26)))
    new, _ = compared(
        before, made(("step 30 mm", "seizes", 12, (4, 27), (8, 27), (0, 26))), tmp_path
    )
    assert new == ["step 30 mm"]
    new, _ = compared(
        before, made(("step 30 mm", "seizes", 9, (8, 27), (1, 27), (0, 26))), tmp_path
    )
    assert new == []


def test_without_changes_nothing_is_reported(made: Made, tmp_path: Path) -> None:
    check = made(("step 30 mm", "seizes", 10), lint=(WARNING,))
    assert compared(check, check, tmp_path) == ([], "")


WARNING = Finding(
    rule="effort", severity="warning", message="2 of 8 wheels, left_wheel_1", where="a.sdf:12, 14"
)


@pytest.mark.parametrize(
    ("changed", "new"),
    [
        ({"where": "a.sdf:99"}, []),
        ({"message": "3 of 9 wheels, left_wheel_1"}, []),
        ({"severity": "note"}, []),
        ({"message": "2 of 8 wheels, left_wheel_2"}, ["effort"]),
        ({"rule": "other"}, ["other"]),
        ({"severity": "error"}, ["effort"]),
        ({"rule": "other", "severity": "note"}, []),
    ],
)
def test_lint_is_new_by_its_words_and_severity_and_not_by_lines_and_figures(
    made: Made, tmp_path: Path, changed: Any, new: list[str]
) -> None:
    now = dataclasses.replace(WARNING, **changed)
    found, changes = compared(made(lint=(WARNING,)), made(lint=(now,)), tmp_path)
    assert found == new
    if new:
        assert f"new {now.severity} of lint, {now.rule}: {now.message}" in changes


def test_other_line_numbers_in_a_warning_are_no_change(made: Made, tmp_path: Path) -> None:
    before, now = (
        Finding(
            rule="other", severity="warning", message=f"a.sdf:{line}: mesh is left out, got b.stl"
        )
        for line in (12, 345)
    )
    assert compared(made(lint=(before,)), made(lint=(now,)), tmp_path) == ([], "")
    (kept,) = entry_of(made(lint=(before,)))["lint"]
    assert kept == ["warning", "other", "a.sdf: mesh is left out, got b.stl"]


def test_findings_that_are_gone_are_reported(made: Made, tmp_path: Path) -> None:
    before = made(("step 30 mm", "seizes", 10), ("gap 9 mm", "seizes", 10), lint=(WARNING,))
    new, changes = compared(before, made(("step 30 mm", "does not seize", 0)), tmp_path)
    assert new == []
    assert (
        "step 30 mm: seizes is now does not seize: seizes in 0 of 80 runs, was 10 of 80" in changes
    )
    assert "no longer driven over: gap 9 mm" in changes
    assert "warning of lint is gone, effort" in changes


def test_obstacles_of_another_size_are_the_same_obstacles(made: Made, tmp_path: Path) -> None:
    before = made(("step 90 mm", "does not seize", 0), ("step 30 mm", "seizes", 10))
    now = made(("step 35 mm", "seizes", 10), ("step 105 mm", "does not seize", 0), mass=15.0)
    new, changes = compared(before, now, tmp_path)
    assert new == []
    assert (
        "obstacles of other sizes: step 30 mm is now step 35 mm, step 90 mm is now step" in changes
    )
    assert "another robot: robot.mass" in changes
    assert "is now 15" in changes


def test_a_seizure_on_an_obstacle_that_the_baseline_lacks_is_new(
    made: Made, tmp_path: Path
) -> None:
    before = made(("step 30 mm", "seizes", 10))
    now = made(("step 30 mm", "seizes", 10), ("gap 9 mm", "seizes", 10))
    new, changes = compared(before, now, tmp_path)
    assert new == ["gap 9 mm"]
    assert "gap 9 mm: seizes; the baseline has no such obstacle" in changes


def test_another_version_is_reported_where_a_verdict_changed(made: Made, tmp_path: Path) -> None:
    before, now = made(("step 30 mm", "not certain", 7)), made(("step 30 mm", "seizes", 9))
    assert "CHANGELOG" not in compared(before, now, tmp_path)[1]
    path = tmp_path / "audit.json"
    kept = json.loads(path.read_text("utf-8"))
    (entry,) = kept["models"].values()
    entry["crawler2d"] = "0.0.9"
    path.write_text(json.dumps(kept), encoding="utf-8")
    _, changes = compare(now, read_baseline(path), path)
    assert changes[-1].startswith("crawler2d 0.0.9 (")
    assert f"is now {c2d.__version__} (" in changes[-1]
    assert "CHANGELOG.md" in changes[-1]
    assert compare(before, read_baseline(path), path)[1] == []


def test_everything_is_new_in_a_file_without_a_baseline(made: Made, tmp_path: Path) -> None:
    check = made(("step 30 mm", "seizes", 10))
    path = tmp_path / "audit.json"
    write_baseline(path, [check], None)
    other = dataclasses.replace(check, path=check.path.with_name("other.urdf"))
    new, changes = compare(other, read_baseline(path), path)
    assert new.failing == check.issues
    assert changes == ["not in the baseline: everything is new"]


def test_a_baseline_names_files_from_its_own_folder(
    made: Made, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "models").mkdir()
    monkeypatch.chdir(tmp_path)
    check = dataclasses.replace(made(), path=Path("models/a.urdf"))
    write_baseline(Path("audit.json"), [check], None)
    assert list(read_baseline(Path("audit.json"))["models"]) == ["models/a.urdf"]
    monkeypatch.chdir(tmp_path / "models")
    path = Path("../audit.json")
    assert (
        compare(dataclasses.replace(check, path=Path("a.urdf")), read_baseline(path), path)[1] == []
    )


def test_an_update_keeps_what_the_baseline_has_of_other_files(made: Made, tmp_path: Path) -> None:
    check, path = made(("step 30 mm", "seizes", 10)), tmp_path / "audit.json"
    other = dataclasses.replace(check, path=check.path.with_name("other.urdf"))
    write_baseline(path, [check, other], None)
    whole = read_baseline(path)
    lint_alone = dataclasses.replace(
        check,
        found=dataclasses.replace(check.found, verdicts=()),  # type: ignore[type-var]
    )
    write_baseline(path, [lint_alone], whole)
    assert read_baseline(path) == whole


def test_a_baseline_is_a_line_for_each_thing(made: Made, tmp_path: Path) -> None:
    path = tmp_path / "audit.json"
    write_baseline(path, [made(("step [30] mm", "seizes", 10), lint=(WARNING,))], None)
    lines = path.read_text("utf-8").splitlines()
    assert any(
        line.strip().startswith('"belt_cleared": [') and line.endswith("],") for line in lines
    )
    assert '["warning", "effort", "2 of 8 wheels, left_wheel_1"]' in map(str.strip, lines)
    assert '"step [30] mm": {' in map(str.strip, lines)


@pytest.mark.parametrize(
    "part",
    [
        {"lint": [["odd", "size", "too long"]]},
        {"lint": [["error", "size"]]},
        {"verdicts": {"step": {"word": "seizes"}}},
        {"verdicts": {"step": {"word": "seizes", "seized": []}}},
        {"verdicts": {"step": {"word": "seizes", "seized": [[1, 9]]}}},
        {"verdicts": {"step": {"word": "seizes", "seized": [[1, 9, "0.0", 0.5]]}}},
        {"lint": [["error", "size", 3]]},
        {"robot": None},
    ],
)
def test_an_entry_that_lacks_a_part_is_refused_before_anything_is_compared(
    tmp_path: Path, part: dict[str, Any]
) -> None:
    entry = {"crawler2d": "1", "build": "x", "robot": {}, "lint": [], **part}
    file = tmp_path / "audit.json"
    file.write_text(json.dumps({"baseline": 1, "models": {"a.sdf": entry}}), encoding="utf-8")
    with refusing(SAID, "must have whole entries"):
        read_baseline(file)
    whole = {"word": "seizes", "seized": [[1, 9, 0.0, 0.5]]}
    entry |= {"robot": {}, "lint": [["note", "sides", "differ"]], "verdicts": {"step": whole}}
    file.write_text(json.dumps({"baseline": 1, "models": {"a.sdf": entry}}), encoding="utf-8")
    assert read_baseline(file)["models"]["a.sdf"] == entry


@pytest.mark.parametrize(
    ("text", "path"),
    [
        ("", "baseline"),
        ("[]", "baseline"),
        ('{"baseline": 1}', "baseline"),
        ('{"baseline": 2, "models": {}}', "baseline"),
        ('{"baseline": 1, "models": []}', "baseline"),
        ('{"baseline": 1, "models": {"a.sdf": {"lint": []}}}', "baseline"),
        ('{"baseline": 1, "models": {"a.sdf": null}}', "baseline"),
    ],
)
def test_a_file_that_is_no_baseline_is_refused(tmp_path: Path, text: str, path: str) -> None:
    file = tmp_path / "audit.json"
    file.write_text(text, encoding="utf-8")
    with refusing(SAID, "--update-baseline") as caught:
        read_baseline(file)
    assert caught.value.path == path
