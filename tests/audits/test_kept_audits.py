"""Reports of audits in a terminal, as a page and as data are as in `kept`, word for word."""

import json
import re
from collections.abc import Callable
from dataclasses import replace
from difflib import unified_diff
from pathlib import Path

import pytest

import crawler2d as c2d
from crawler2d.audits.baseline import compare, read_baseline, write_baseline
from crawler2d.audits.issues import check_of, junit_of, sarif_of, unreadable
from crawler2d.audits.page import sections
from crawler2d.audits.record import AuditRecord
from crawler2d.audits.text import plain_of, text_of
from tests.audits.made import doubtful, made_of_file, made_of_robot
from tests.kept import check_kept

KEPT = Path(__file__).parent / "kept"


@pytest.fixture(scope="module")
def audits(tmp_path_factory: pytest.TempPathFactory) -> dict[str, AuditRecord]:
    of_file = made_of_file(tmp_path_factory.mktemp("made"))
    return {"file": of_file, "doubtful": doubtful(of_file), "robot": made_of_robot()}


def check_each(
    audits: dict[str, AuditRecord], kind: str, write: Callable[[AuditRecord], str]
) -> None:
    """Compare the report of each audit; for the doubtful one, its differences are stored."""
    texts = {name: write(audit) for name, audit in audits.items()}
    for name in ("file", "robot"):
        check_kept(KEPT / f"{name}.{kind}", texts[name])
    whole, doubtful = (texts[name].splitlines() for name in ("file", "doubtful"))
    changes = unified_diff(whole, doubtful, "file", "doubtful", lineterm="", n=0)
    check_kept(KEPT / f"doubtful.{kind}.diff", "\n".join(changes))


def test_the_text_of_an_audit_is_as_kept(audits: dict[str, AuditRecord]) -> None:
    check_each(audits, "txt", text_of)


def test_the_data_of_an_audit_are_as_kept(audits: dict[str, AuditRecord]) -> None:
    check_each(audits, "json", lambda audit: rounded(json.dumps(plain_of(audit), indent=1)))


def test_the_sections_of_a_page_are_as_kept(audits: dict[str, AuditRecord]) -> None:
    check_each(audits, "html", page_of)


def page_of(audit: AuditRecord) -> str:
    """Write the sections of a page, with one tag per line."""
    diffs = {each.description: "-old\n+<new>" for each in audit.repairs[:1]}
    parts = {
        "answer": sections.answer_section(audit),
        "verdicts": sections.verdict_section(audit, {"stairs": 1}),
        "lint": sections.lint_section(audit),
        "repairs": sections.repair_section(audit, diffs),
        "robot": sections.robot_section(audit),
        "method": re.sub(r"build_id \w+|version [\d.]+", "", sections.method_section(audit)),
        "command": sections.command(audit),
    }
    text = "".join(f"{part}: {each}\n" for part, each in parts.items())
    if audit.reading is not None:
        text = text.replace(str(audit.reading.path.parent), "FOLDER")
    return rounded(re.sub(r"(?<=>)(?=<)", "\n", text))


def test_what_other_programs_read_of_audits_is_as_kept(
    audits: dict[str, AuditRecord], tmp_path: Path
) -> None:
    """Three files, one of which cannot be read, with and without a baseline."""
    (tmp_path / ".git").mkdir()
    checks = [check_of(tmp_path / f"{name}.urdf", audits[name]) for name in ("file", "doubtful")]
    error = c2d.ScenarioError("broken.urdf:3, 7", 1, "must be 2")
    checks.append(unreadable(tmp_path / "broken.urdf", error))
    known = [replace(each, known=frozenset(each.issues[::2])) for each in checks]
    version = c2d.build_info()["version"]
    for name, every in (("alone", checks), ("baseline", known)):
        check_kept(KEPT / f"{name}.xml", junit_of(every).replace(str(tmp_path), "FOLDER"))
        sarif = sarif_of(every).replace(f'"semanticVersion": "{version}"', "")
        check_kept(KEPT / f"{name}.sarif", sarif)


def test_a_baseline_and_what_changed_since_it_are_as_kept(
    audits: dict[str, AuditRecord], tmp_path: Path
) -> None:
    whole, doubtful = audits["file"], audits["doubtful"]
    heavy = replace(whole.robot, mass=20.5, center_of_mass=(0.01, 0.02), belly=None, gauge=0.3)
    smaller = tuple(
        replace(each, obstacle=each.obstacle.replace("75", "62.5")) for each in whole.verdicts[:-2]
    )
    changed = replace(whole, robot=heavy, verdicts=smaller)
    path, model = tmp_path / "audit.json", tmp_path / "cart.urdf"
    checks = [check_of(model, each) for each in (whole, doubtful, changed)]
    write_baseline(path, checks[:1], None)
    build = c2d.build_info()
    own = f'"crawler2d": "{build["version"]}",\n   "build": "{build["build_id"]}"'
    text = path.read_text(encoding="utf-8")
    assert own in text
    check_kept(KEPT / "baseline.json", rounded(text.replace(own, "")))
    lines = []
    for check in checks:
        write_baseline(path, [check], None)
        baseline = read_baseline(path)
        lines += [line for now in checks for line in ["-", *compare(now, baseline, path)[1]]]
    check_kept(KEPT / "changes.txt", "\n".join(lines))


def rounded(text: str) -> str:
    """Remove digits that depend on rounding."""
    return re.sub(r"\d+\.\d{7,}(e-?\d+)?", lambda found: f"{float(found[0]):.6g}", text)
