"""The audit in a robot's own repository: options of the command, the GitHub action, the hooks."""

import argparse
import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

import crawler2d as c2d
from crawler2d.__main__ import main
from crawler2d.audits.text import plain_of
from crawler2d.commands import audit as command
from tests.audits.seizing import instant_audit, seizing_file
from tests.shared import NO_DASK
from tests.walls.rooms import ROOT


def run(capsys: Any, *arguments: str) -> tuple[int, str, str]:
    status = main(["audit", *arguments])
    printed = capsys.readouterr()
    return status, printed.out, printed.err


@pytest.fixture
def repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A repository of robots; its root is the working directory."""
    (tmp_path / ".git").mkdir()
    (tmp_path / "models").mkdir()
    for name in ("one", "two"):
        (tmp_path / "models" / f"{name}.urdf").write_text(seizing_file(name), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def quick(repository: Path, monkeypatch: pytest.MonkeyPatch, of_file: c2d.Audit) -> Path:
    """The same with instant audits, which all return the result of a cart that seizes."""
    monkeypatch.setattr(command, "audit", instant_audit(of_file))
    monkeypatch.setattr(c2d.Audit, "to_html", lambda _, path, **__: path.write_text("a page"))
    return repository


def test_lint_takes_no_runs_and_its_errors_are_the_exit_status(
    repository: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(command, "audit", None)
    status, out, err = run(capsys, "--lint", "models/one.urdf")
    assert (status, err) == (0, "")
    assert out.startswith("one: 4 round wheels in a line")
    text = seizing_file().replace('radius="0.0608"', 'radius="0.9"')
    Path("models/two.urdf").write_text(text.replace('xyz="0.', 'xyz="9.'), encoding="utf-8")
    status, out, _ = run(capsys, "--lint", "models/two.urdf")
    assert "error, size" in out
    assert status == 1
    assert not (repository / "out").exists()


def test_lint_as_json_is_what_an_audit_has_without_its_runs(
    repository: Path, capsys: Any, of_file: c2d.Audit
) -> None:
    status, out, err = run(capsys, "--lint", "--json", "models/one.urdf")
    assert repository.is_dir()
    assert status == 0
    found = json.loads(out)
    whole = plain_of(of_file)
    assert [key for key in whole if key in found] == list(found)
    assert {"robot", "sources", "lint", "pockets"} <= found.keys()
    assert "verdicts" not in found
    assert err.startswith("one: 4 round wheels in a line")


def test_a_file_that_cannot_be_read_is_an_error_in_the_reports_of_all(
    quick: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch, of_file: c2d.Audit
) -> None:
    assert quick.is_dir()
    of_one = instant_audit(of_file)

    def audit(file: Path, **how: Any) -> c2d.Audit:
        if file.stem == "two":
            raise c2d.ScenarioError("two.urdf:3: link[hull]", -1.0, "must have a mass >= 0 kg")
        found: c2d.Audit = of_one(file, **how)
        return found

    monkeypatch.setattr(command, "audit", audit)
    reports = ("--junit", "junit.xml", "--sarif", "audit.sarif")
    status, _, err = run(capsys, "models/two.urdf", "models/one.urdf", *reports)
    assert status == 2
    assert "two.urdf:3" in err
    two, one = ElementTree.parse("junit.xml").getroot()
    assert (two.get("failures"), two.get("errors")) == ("0", "1")
    assert len(one) > 1
    first = json.loads(Path("audit.sarif").read_text("utf-8"))["runs"][0]["results"][0]
    assert (first["ruleId"], first["level"]) == ("unread", "error")
    assert first["locations"][0]["physicalLocation"]["region"] == {"startLine": 3}


@pytest.mark.parametrize("kind", [c2d.LimitError, c2d.SimulationDiverged, c2d.errors.InternalError])
def test_a_file_whose_audit_fails_does_not_end_those_of_the_others(
    quick: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch, of_file: c2d.Audit, kind: Any
) -> None:
    assert quick.is_dir()
    of_one = instant_audit(of_file)

    def audit(file: Path, **how: Any) -> c2d.Audit:
        if file.stem == "two":
            raise kind("chassis is not finite")
        found: c2d.Audit = of_one(file, **how)
        return found

    monkeypatch.setattr(command, "audit", audit)
    status, out, err = run(capsys, "models/two.urdf", "models/one.urdf", "--junit", "junit.xml")
    assert (status, out.count("Verdicts: ")) == (2, 1)
    assert err == f"crawler2d audit: {Path('models/two.urdf')}: chassis is not finite\n"
    two, one = ElementTree.parse("junit.xml").getroot()
    assert (two.get("failures"), two.get("errors")) == ("0", "1")
    assert len(one) > 1


def test_several_files_are_audited_one_after_the_other(quick: Path, capsys: Any) -> None:
    reports = ("--junit", "junit.xml", "--sarif", "audit.sarif")
    status, out, _ = run(capsys, "models/one.urdf", "models/two.urdf", *reports)
    assert status == 1
    assert out.count("Verdicts: ") == 2
    assert sorted(path.name for path in Path("out").iterdir()) == [
        "audit-one.html",
        "audit-two.html",
    ]
    suites = ElementTree.parse("junit.xml").getroot()
    assert [suite.attrib["name"] for suite in suites] == ["models/one.urdf", "models/two.urdf"]
    (log,) = json.loads(Path("audit.sarif").read_text("utf-8"))["runs"]
    places = [each["locations"][0]["physicalLocation"] for each in log["results"]]
    uris = {place["artifactLocation"]["uri"] for place in places}
    assert uris == {"models/one.urdf", "models/two.urdf"}
    assert quick.is_dir()


def test_pages_of_files_of_one_name_are_told_apart_by_folders(quick: Path, capsys: Any) -> None:
    files = ["a/model.sdf", "b/model.sdf", str(quick / "c.sdf")]
    run(capsys, *files)
    names = {path.name for path in Path("out").iterdir()}
    assert names == {"audit-a-model.sdf.html", "audit-b-model.sdf.html", "audit-c.html"}


def test_a_baseline_is_written_compared_and_updated(quick: Path, capsys: Any) -> None:
    both = ("models/one.urdf", "models/two.urdf", "--no-html")
    status, _, err = run(capsys, *both, "--baseline", "audit.json")
    assert status == 2
    assert "--update-baseline" in err
    update = ("--baseline", "audit.json", "--update-baseline")
    status, out, _ = run(capsys, models := "models/one.urdf", "--no-html", *update)
    assert (status, out.splitlines()[-1]) == (0, "The baseline is in audit.json")
    # It seizes as before: nothing is new.
    status, out, _ = run(capsys, models, "--no-html", "--baseline", "audit.json")
    assert status == 0
    assert "Since the baseline, models/one.urdf: nothing moved" in out
    assert out.splitlines()[-1].startswith("0 new, ")
    # The other file is not there yet.
    status, out, _ = run(capsys, *both, "--baseline", "audit.json")
    assert status == 1
    assert "not in the baseline: everything is new" in out
    status, out, _ = run(capsys, *both, *update)
    assert status == 0
    assert run(capsys, *both, "--baseline", "audit.json")[0] == 0
    assert quick.is_dir()


def test_with_json_the_baseline_is_reported_on_the_other_stream(quick: Path, capsys: Any) -> None:
    baseline = ("--baseline", "audit.json", "--update-baseline")
    _, out, err = run(capsys, "models/one.urdf", "--no-html", "--json", *baseline)
    assert json.loads(out)["seizes"] is True
    assert "The baseline is in audit.json" in err
    assert (quick / "audit.json").is_file()


@pytest.mark.parametrize(
    "arguments",
    [
        ["a.sdf", "b.sdf", "--json"],
        ["a.sdf", "b.sdf", "--html", "page.html"],
        ["a.sdf", "b.sdf", "--patch", "c.sdf"],
        ["a.sdf", "--lint", "--html", "page.html"],
        ["a.sdf", "--lint", "--samples", "5"],
        ["a.sdf", "--lint", "--store", "runs.store"],
        ["a.sdf", "--update-baseline"],
        ["a.sdf", "--baseline", "none.json"],
        ["a.sdf", "--baseline", "none/a.json", "--update-baseline"],
    ],
)
def test_options_that_do_not_go_together_are_refused_before_any_run(
    quick: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch, arguments: list[str]
) -> None:
    monkeypatch.setattr(command, "audit", None)
    status, out, err = run(capsys, *arguments)
    assert (status, out) == (2, "")
    assert err.startswith(f"crawler2d audit: --{'html' if '--html' in arguments else ''}")
    assert len(err.strip().splitlines()) == 1
    assert quick.is_dir()


def test_every_option_that_the_page_names_is_one() -> None:
    parser = argparse.ArgumentParser()
    command.add_arguments(parser)
    page = (ROOT / "docs/guide/audit.md").read_text("utf-8")
    named = set(re.findall(r"(?<![\w-])--[a-z][a-z-]+", page))
    assert len(named) > 8
    assert named <= {option for each in parser._actions for option in each.option_strings}


def yaml(name: str) -> Any:
    return pytest.importorskip("yaml").safe_load((ROOT / name).read_text("utf-8"))


# Its arguments are those of `python -m crawler2d`.
ON_ONE_STEP = f"""{NO_DASK}
import crawler2d as c2d
from crawler2d.__main__ import main
from crawler2d.audits.text import plain_of
from crawler2d.audits import audit, page
page.chart_section = lambda *_: ""
audit.check_assumptions = lambda *_: ()  # bouncing takes most of the time
audit.standard_obstacles = lambda *_: {{"step of 75 mm": c2d.terrains.step(0.075)}}
sys.exit(main(sys.argv[3:]))
"""


def python_of_this_test(folder: Path, *program: str) -> dict[str, str]:
    """An environment in which `python` is the interpreter of this test, with its package.

    It can run another program instead of the requested one.
    """
    (folder / "bin").mkdir()
    shim = folder / "bin" / "python"
    words = shlex.join([sys.executable, *program])
    shim.write_text(f'#!/bin/sh\nexec {words} "$@"\n', encoding="utf-8")
    shim.chmod(0o755)
    package = Path(c2d.__file__).parents[1]
    return {
        **os.environ,
        "PATH": f"{folder / 'bin'}:{os.environ['PATH']}",
        "PYTHONPATH": str(package),
    }


def step(action: Any, name: str, inputs: dict[str, str], env: dict[str, str]) -> Any:
    """Run a step of the action like GitHub."""
    usual = {key: str(each.get("default", "")) for key, each in action["inputs"].items()}
    given = {**usual, **inputs}
    (found,) = [each for each in action["runs"]["steps"] if each.get("name") == name]
    filled = {
        key: re.sub(r"\$\{\{ inputs\.([\w-]+) \}\}", lambda match: given[match[1]], text)
        for key, text in found["env"].items()
    }
    assert not any("${{" in text for text in filled.values())
    words = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", found["run"]]
    return subprocess.run(words, env={**env, **filled}, capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    "program",
    [
        pytest.param(("-c", ON_ONE_STEP), id="one obstacle"),
        pytest.param((), id="standard obstacles", marks=pytest.mark.soak),
    ],
)
@pytest.mark.skipif(sys.platform == "win32", reason="needs a POSIX shell")
def test_the_action_audits_the_models_of_a_repository(
    repository: Path, tmp_path: Path, program: tuple[str, ...]
) -> None:
    action = yaml("action.yml")
    files = {name: tmp_path / name for name in ("GITHUB_STEP_SUMMARY", "GITHUB_OUTPUT")}
    python = python_of_this_test(tmp_path, *program)
    env = {**python, **{key: str(path) for key, path in files.items()}}
    few = {"args": "--samples 1 --repeats 1 --no-repairs --threads 2", "files": "models/*.urdf"}
    done = step(action, "Audit", few, env)
    assert done.returncode == 1, done.stderr
    summary = files["GITHUB_STEP_SUMMARY"].read_text("utf-8")
    assert summary.startswith("## crawler2d audit: models/one.urdf models/two.urdf\n```text\n")
    assert summary.count("It seizes on ") == 2
    assert files["GITHUB_OUTPUT"].read_text("utf-8") == "sarif=out/audit.sarif\nstatus=1\n"
    left = {path.name for path in (repository / "out").glob("audit*")}
    assert left >= {"audit.sarif", "audit-junit.xml", "audit-one.html", "audit-two.html"}


@pytest.mark.skipif(sys.platform == "win32", reason="needs a POSIX shell")
def test_the_action_says_what_is_wrong_with_a_file(repository: Path, tmp_path: Path) -> None:
    action = yaml("action.yml")
    files = {name: tmp_path / name for name in ("GITHUB_STEP_SUMMARY", "GITHUB_OUTPUT")}
    env = {**python_of_this_test(tmp_path), **{key: str(path) for key, path in files.items()}}
    done = step(action, "Audit", {"files": "models/none.sdf", "quick": "true"}, env)
    assert done.returncode == 2
    assert "\ncrawler2d audit: " in files["GITHUB_STEP_SUMMARY"].read_text("utf-8")
    assert files["GITHUB_OUTPUT"].read_text("utf-8") == "sarif=out/audit.sarif\nstatus=2\n"
    assert repository.is_dir()


def test_the_action_installs_its_own_revision_and_keeps_what_it_made() -> None:
    action = yaml("action.yml")
    assert action["runs"]["using"] == "composite"
    steps = {each.get("name", each.get("uses")): each for each in action["runs"]["steps"]}
    assert "file://$GITHUB_ACTION_PATH" in steps["Install"]["run"]
    assert steps["actions/upload-artifact@v4"]["if"] == "always()"
    # A step that runs something has a shell, and every input is used.
    assert all("shell" in each for each in steps.values() if "run" in each)
    text = (ROOT / "action.yml").read_text("utf-8")
    assert all(f"${{{{ inputs.{name} }}}}" in text for name in action["inputs"])


@pytest.mark.skipif(sys.platform == "win32", reason="needs a POSIX shell")
def test_the_lint_hook_takes_all_changed_models_at_once(repository: Path, tmp_path: Path) -> None:
    hooks = {hook["id"]: hook for hook in yaml(".pre-commit-hooks.yaml")}
    assert set(hooks) == {"crawler2d-lint", "crawler2d-audit"}
    for hook in hooks.values():
        assert re.search(hook["files"], "models/one.urdf")
        assert not re.search(hook["files"], "package.xml")
    env = python_of_this_test(tmp_path)
    names = ["models/one.urdf", "models/two.urdf"]
    words = [*shlex.split(hooks["crawler2d-lint"]["entry"]), *names]
    done = subprocess.run(words, env=env, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count("Pockets") == 2
    assert not (repository / "out").exists()


def test_the_audit_hook_is_a_command_that_writes_no_page(quick: Path, capsys: Any) -> None:
    (hook,) = [each for each in yaml(".pre-commit-hooks.yaml") if each["id"] == "crawler2d-audit"]
    python, dash, package, program, *options = shlex.split(hook["entry"])
    assert (python, dash, package, program) == ("python", "-m", "crawler2d", "audit")
    assert run(capsys, *options, "models/one.urdf", "models/two.urdf")[0] == 1
    assert not (quick / "out").exists()
