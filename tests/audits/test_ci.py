"""Reports for continuous integration: JUnit XML and SARIF, in the forms that their readers need."""

import dataclasses
import json
import os
import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

import crawler2d as c2d
from crawler2d.audits.issues import Check, check_of, junit_of, sarif_of
from crawler2d.audits.lint import RULES, Finding
from crawler2d.audits.text import lint_only
from crawler2d.audits.verdicts import Proportion
from tests.audits.seizing import seizing_file
from tests.reading.carts import FILES
from tests.walls.rooms import ROOT

ODD = (
    Finding(rule="friction", severity="error", message="friction of 5", where="cart.urdf:12, 14"),
    Finding(
        rule="effort", severity="warning", message="no limit", where="cart.urdf:3 to 9, 7 lines"
    ),
    Finding(rule="effort", severity="note", message="a note", where=""),
)


@pytest.fixture
def check(of_file: c2d.Audit) -> Check:
    """A cart that seizes on the first of two steps, and breaks two rules of lint."""
    assert of_file.reading is not None
    assert [each.result for each in of_file.verdicts] == ["seizes", "not certain"]
    return check_of(of_file.reading.path, dataclasses.replace(of_file, lint=ODD))


def cases(text: str) -> dict[str, ElementTree.Element]:
    """The test cases by name, after checks against the schema of Jenkins."""
    root = ElementTree.fromstring(text.encode())
    assert root.tag == "testsuites"
    suites = list(root)
    for suite in suites:
        assert suite.tag == "testsuite"
        assert {"name", "tests", "failures", "errors", "skipped"} == set(suite.attrib)
        assert {case.tag for case in suite} <= {"testcase"}
        assert int(suite.attrib["tests"]) == len(suite)
        for name, tag in (("failures", "failure"), ("errors", "error"), ("skipped", "skipped")):
            assert int(suite.attrib[name]) == len(suite.findall(f"testcase/{tag}"))
        names = [case.attrib["name"] for case in suite]
        assert len(set(names)) == len(names)
        for case in suite:
            assert set(case.attrib) == {"name", "classname"}
            assert {part.tag for part in case} <= {"failure", "error", "skipped", "system-out"}
            assert len({part.tag for part in case}) == len(case)
            for part in case:
                assert set(part.attrib) <= {"type", "message"}
    for name in ("tests", "failures", "errors"):
        assert int(root.attrib[name]) == sum(int(suite.attrib[name]) for suite in suites)
    return {case.attrib["name"]: case for suite in suites for case in suite}


def test_an_obstacle_is_a_test_case_and_a_seizure_its_failure(check: Check) -> None:
    found = cases(junit_of([check]))
    seized = found["seizes: step of 75 mm"].find("failure")
    assert seized is not None
    assert seized.attrib["type"] == "seizes"
    assert seized.attrib["message"].startswith("seizes on step of 75 mm in ")
    assert re.search(r"wheels \d-\d of the chassis \(left_\w+, left_\w+\)", str(seized.text))
    assert found["seizes: step of 30 mm"].find("failure") is None
    assert "not certain" in str(found["seizes: step of 30 mm"].findtext("system-out"))


def test_a_report_says_which_runs_have_no_result(check: Check) -> None:
    assert check.found is not None
    verdict = check.found.verdicts[1]
    none = Proportion()
    no_belt: dict[str, Any] = {"belt_cleared": none, "belt_seized": none, "belt_outcome": "failed"}
    for changes, line in (
        ({**no_belt, "belt_outcome": ""}, ", belt not simulated"),
        (no_belt, ", belt: no result"),
        ({"cleared": none, "seized": none, **no_belt}, "; no run has a result, belt: no result"),
    ):
        verdicts = (dataclasses.replace(verdict, **changes),)
        found = dataclasses.replace(check.found, verdicts=verdicts)
        text = junit_of([dataclasses.replace(check, found=found)])
        assert str(cases(text)["seizes: step of 30 mm"].findtext("system-out")).endswith(line)


def test_a_broken_rule_is_a_test_case_that_fails_by_its_errors_alone(check: Check) -> None:
    found = cases(junit_of([check]))
    assert list(found) == [
        "seizes: step of 75 mm",
        "seizes: step of 30 mm",
        "lint: friction",
        "lint: effort",
    ]
    failure = found["lint: friction"].find("failure")
    assert failure is not None
    assert str(failure.text).endswith("cart.urdf:12: friction of 5")
    assert found["lint: effort"].find("failure") is None
    said = str(found["lint: effort"].findtext("system-out")).splitlines()
    assert [line.partition(":")[0] for line in said] == ["warning", "note"]


def test_known_issues_are_skipped_and_new_warnings_fail(check: Check) -> None:
    known = dataclasses.replace(check, known=frozenset(check.issues))
    found = cases(junit_of([known]))
    skipped = {name for name, case in found.items() if case.find("skipped") is not None}
    assert skipped == {"seizes: step of 75 mm", "lint: friction", "lint: effort"}
    found = cases(junit_of([dataclasses.replace(check, known=frozenset())]))
    failed = {name for name, case in found.items() if case.find("failure") is not None}
    assert failed == {"seizes: step of 75 mm", "lint: friction", "lint: effort"}


def test_any_name_of_a_file_gives_xml(check: Check) -> None:
    odd = dataclasses.replace(check, path=Path('a\x07 <b> & "c".urdf'))
    text = junit_of([odd])
    assert len(cases(text)) == 4
    suite = ElementTree.fromstring(text.encode())[0]
    assert suite.attrib["name"] == 'a\ufffd <b> & "c".urdf'


def test_any_name_of_a_file_has_an_address(check: Check) -> None:
    odd = dataclasses.replace(check, path=Path(os.fsdecode(b"caf\xe9 %.urdf")))
    assert where(odd)["uri"] == "caf%E9%20%25.urdf"


def results(text: str) -> list[dict[str, Any]]:
    """The results, after checks of all requirements of SARIF 2.1.0 and code scanning."""
    log = json.loads(text)
    assert log["version"] == "2.1.0"
    assert log["$schema"].endswith("sarif-2.1.0.json")
    assert set(log) == {"$schema", "version", "runs"}
    (run,) = log["runs"]
    driver = run["tool"]["driver"]
    assert (driver["name"], driver["semanticVersion"]) == ("crawler2d", c2d.__version__)
    ids = [rule["id"] for rule in driver["rules"]]
    assert len(set(ids)) == len(ids)
    assert all(" " not in each for each in ids)
    assert all(rule["shortDescription"]["text"] for rule in driver["rules"])
    found: list[dict[str, Any]] = run["results"]
    for result in found:
        assert ids[result["ruleIndex"]] == result["ruleId"]
        assert result["level"] in ("error", "warning", "note")
        assert result["message"]["text"]
        assert len(result["locations"]) == 1
        for place in [*result["locations"], *result.get("relatedLocations", [])]:
            physical = place["physicalLocation"]
            assert not physical["artifactLocation"]["uri"].startswith("/")
            assert physical.get("region", {"startLine": 1})["startLine"] >= 1
    return found


def lines(result: dict[str, Any]) -> list[int]:
    places = [*result["locations"], *result.get("relatedLocations", [])]
    return [place["physicalLocation"]["region"]["startLine"] for place in places]


def test_a_seizure_is_at_the_lines_of_the_wheels(check: Check) -> None:
    seized = results(sarif_of([check]))[0]
    assert (seized["ruleId"], seized["level"]) == ("seizes", "error")
    names = re.search(r"\((left_\w+), (left_\w+)\)", seized["message"]["text"])
    assert names is not None
    text = check.path.read_text(encoding="utf-8").splitlines()
    at = [text[line - 1] for line in lines(seized)]
    assert [f'<link name="{name}">' in line for name, line in zip(names.groups(), at, strict=True)]
    assert all("<link" in line for line in at)


def test_lint_is_at_its_lines(check: Check) -> None:
    _, friction, effort, note = results(sarif_of([check]))
    assert [each["level"] for each in (friction, effort, note)] == ["error", "warning", "note"]
    assert lines(friction) == [12, 14]
    assert lines(effort) == [3]
    assert "region" not in note["locations"][0]["physicalLocation"]
    assert [each["ruleId"] for each in (friction, effort)] == ["friction", "effort"]


def where(check: Check) -> dict[str, str]:
    place = results(sarif_of([check]))[0]["locations"][0]["physicalLocation"]
    found: dict[str, str] = place["artifactLocation"]
    return found


def test_files_are_named_from_the_root_of_their_repository(
    check: Check, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / ".git").mkdir()
    folder = tmp_path / "my models"
    folder.mkdir()
    (folder / "cart.urdf").write_text(seizing_file(), encoding="utf-8")
    monkeypatch.chdir(folder)
    moved = dataclasses.replace(check, path=Path("cart.urdf"))
    assert where(moved) == {"uri": "my%20models/cart.urdf", "uriBaseId": "%SRCROOT%"}


def test_files_outside_of_a_repository_are_named_from_the_folder_that_is_current(
    check: Check, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(check.path.parent)
    assert where(check)["uri"] == "cart.urdf"


def test_a_result_says_whether_the_baseline_has_it(check: Check) -> None:
    assert "baselineState" not in results(sarif_of([check]))[0]
    compared = dataclasses.replace(check, known=frozenset(check.issues[:1]))
    states = [result["baselineState"] for result in results(sarif_of([compared]))]
    assert states == ["unchanged", "new", "new", "new"]


def test_findings_in_expanded_xacro_have_no_lines_of_the_file(tmp_path: Path) -> None:
    pytest.importorskip("xacrodoc")
    path = tmp_path / "cart.xacro"
    text = (FILES / "cart.xacro").read_text(encoding="utf-8")
    path.write_text(text.replace('mass value="', 'mass value="9'), encoding="utf-8")
    check = check_of(path, lint_only(path))
    assert check.found is not None
    if check.found.reading is not None and check.found.reading.tree.file == path.name:
        pytest.skip("its lines are its own")
    assert check.issues
    assert not any(issue.lines for issue in check.issues)


def test_every_rule_of_lint_has_a_check_and_is_documented() -> None:
    assert all(rule.robot or rule.file for rule in RULES)
    assert len({rule.name for rule in RULES}) == len(RULES)
    table = (ROOT / "docs/conventions.md").read_text("utf-8").partition("| rule | fires on |")[2]
    rows = table.partition("\n\n")[0].splitlines()[2:]
    assert [row.split("`")[1] for row in rows] == [rule.name for rule in RULES]


def test_an_audit_without_runs_finds_the_same_lint(of_file: c2d.Audit) -> None:
    assert of_file.reading is not None
    alone = lint_only(of_file.reading.path)
    warned = [each for each in of_file.lint if each.rule == "other"]
    assert [each for each in of_file.lint if each not in warned] == list(alone.lint)
    assert alone.pockets == of_file.pockets
    assert alone.verdicts == ()
    assert str(alone).startswith(of_file.reading.description)
    assert "Pockets" in str(alone)
    assert "Verdicts" not in str(alone)
