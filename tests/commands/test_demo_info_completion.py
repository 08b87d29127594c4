"""`crawler2d demo`, `info` and `completion`."""

import importlib.metadata
import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.__main__ import main
from crawler2d.commands import demo

Capture = pytest.CaptureFixture[str]


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(scope="module")
def runs() -> tuple[c2d.Run, c2d.Run]:
    return demo.demo_runs()


def test_the_demo_seizes_on_wheels_and_clears_on_a_belt(runs: tuple[c2d.Run, c2d.Run]) -> None:
    wheels, belt = runs
    assert (wheels.outcome, belt.outcome) == (c2d.Outcome.SEIZED, c2d.Outcome.CLEARED)
    assert wheels.scenario.terrain == belt.scenario.terrain
    assert wheels.scenario.robot.with_track(c2d.BeltTrack()) == belt.scenario.robot
    assert "edge" in demo.demo_page(runs)


def test_the_demo_has_both_replays_the_diagnosis_and_three_ways_on(
    runs: tuple[c2d.Run, c2d.Run],
) -> None:
    text = demo.demo_page(runs)
    data = json.loads(re.findall(r'id="runs">(.*?)</script>', text)[0])
    assert [each["frames"]["count"] for each in data] == [run.time.size for run in runs]
    assert text.count("<canvas") == 2
    why, _, tried = str(runs[0].diagnosis).partition(". Tried: ")
    assert why in text
    assert tried in text
    for run in runs:
        assert f"{run.ending}</strong>" in text
    assert text.count("<li>") == 3
    assert "crawler2d audit MODEL.sdf" in text
    assert "$" not in re.sub(r"<(script|style).*?</\1>", "", text, flags=re.DOTALL)


def test_the_python_of_the_demo_runs(here: Path) -> None:
    code = demo._NEXT[-1][1]
    subprocess.run([sys.executable, "-c", code], cwd=here, check=True)
    assert "seized" in (here / "run.html").read_text()


def test_the_demo_is_written_and_names_a_model_to_audit(
    here: Path, capsys: Capture, runs: tuple[c2d.Run, c2d.Run]
) -> None:
    wheels, belt = runs
    assert wheels.diagnosis is not None
    assert main(["demo"]) == 0
    out = capsys.readouterr().out.splitlines()
    assert out[:3] == [
        f"on four wheels: seized at {wheels.diagnosis.since:.2f} s",
        f"on a belt: cleared after {belt.metrics['time_to_clear']:.2f} s",
        f"The page is in {Path('out/demo.html')}",
    ]
    assert str(c2d.samples.path()) in out[3]
    assert (here / "out/demo.html").is_file()
    assert main(["demo", "--out", "no/demo.html"]) == 2
    assert "--out must be a file in a folder that exists" in capsys.readouterr().err


def test_info_has_all_that_a_bug_report_needs(capsys: Capture) -> None:
    assert main(["info", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["crawler2d"]["version"] == c2d.__version__
    assert told["core"]["build_id"] == c2d.build_info()["build_id"]
    assert Path(told["core"]["path"]).is_file()
    assert told["numpy"]["version"] == np.__version__
    assert told["python"]["path"] == sys.executable
    assert main(["info"]) == 0
    shown = capsys.readouterr().out
    for text in (c2d.__version__, told["core"]["build_id"], np.__version__, sys.executable):
        assert text in shown


@pytest.fixture
def metadata(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The declared requirements of the installed package."""
    needed: list[str] = []
    monkeypatch.setattr(importlib.metadata, "requires", lambda _: needed)
    return needed


def test_info_lists_present_and_missing_extras(metadata: list[str], capsys: Capture) -> None:
    metadata += [
        "numpy<3,>=2.0",
        "numpy>=2; extra == 'both'",
        'no-such_package.x<2; python_version > "3" and extra == "both"',
        'crawler2d[both]; extra == "all"',
    ]
    assert main(["info", "--json"]) == 0
    (name,) = extras = json.loads(capsys.readouterr().out)["extras"]
    assert name == "both"
    assert extras["both"]["numpy"]["version"] == np.__version__
    assert extras["both"]["no-such_package.x"] is None
    assert main(["info"]) == 0
    said = "missing no-such_package.x: pip install 'crawler2d[both]'"
    assert f"numpy {np.__version__}; {said}" in capsys.readouterr().out


def test_info_works_where_nothing_is_installed(
    monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    def missing(name: str) -> Any:
        raise importlib.metadata.PackageNotFoundError(name)

    monkeypatch.setattr(importlib.metadata, "requires", missing)
    assert main(["info"]) == 0
    assert "extras" in capsys.readouterr().out


def test_a_shell_is_completed_with_commands_options_and_files(capsys: Capture) -> None:
    pytest.importorskip("shtab")
    for shell in ("bash", "zsh", "tcsh"):
        assert main(["completion", shell]) == 0
        text = capsys.readouterr().out
        assert all(name in text for name in ("demo", "schema", "--save", "--baseline"))
    assert main(["completion", "bash"]) == 0
    assert "_shtab_crawler2d_run_pos_0_COMPGEN=_shtab_compgen_files" in capsys.readouterr().out


def test_completion_names_its_extra(monkeypatch: pytest.MonkeyPatch, capsys: Capture) -> None:
    monkeypatch.setitem(sys.modules, "shtab", None)
    assert main(["completion", "bash"]) == 2
    assert capsys.readouterr().err == (
        "crawler2d completion: this needs shtab: pip install 'crawler2d[cli]'\n"
    )
