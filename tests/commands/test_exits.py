"""Exit of commands: status, after Ctrl-C, and with a closed pipe."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import crawler2d as c2d
from crawler2d.__main__ import Command, main, run_command
from tests.shared import ROBOT

SOLVER = c2d.Solver(time_step=1e-3)
LONG = c2d.Scenario(ROBOT, c2d.terrains.flat(length=900.0), duration=10000.0, solver=SOLVER)

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to a child")


def started(folder: Path, *arguments: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-W", "ignore", "-m", "crawler2d", *arguments],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        cwd=folder,
        text=True,
    )


def interrupted(process: subprocess.Popen[str], text: str) -> tuple[int, str, str]:
    """Interrupt a program after it has read a text; return its status and output."""
    assert process.stdin is not None
    process.stdin.write(text)
    process.stdin.close()
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    process.stdin = None
    try:
        out, err = process.communicate(timeout=30.0)
    finally:
        process.kill()
    return process.returncode, out, err


@pytest.mark.parametrize("command", ["run", "view"])
def test_ctrl_c_ends_a_simulation_in_one_line(tmp_path: Path, command: str) -> None:
    """It reads its file from a pipe; once this is read, imports are finished."""
    text = LONG.to_json()
    with started(tmp_path, command, "-") as process:
        status, out, err = interrupted(process, f"{text}{' ' * 200_000}")
    assert (status, out) == (130, "")
    assert err == f"crawler2d {command}: interrupted: no file was written\n"
    assert not list(tmp_path.rglob("*.html"))


def call(text: str, error: BaseException, capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    """Run a command that ends with an error."""

    def fail(_: object) -> int:
        raise error

    status = run_command(
        "program", text, {"work": Command("Work.", lambda _: None, fail)}, ["work"]
    )
    return status, capsys.readouterr().err


def test_ctrl_c_says_what_a_command_has_kept(capsys: pytest.CaptureFixture[str]) -> None:
    interrupt = KeyboardInterrupt()
    assert call("", interrupt, capsys) == (130, "program work: interrupted\n")
    interrupt.add_note("run.npz is complete")
    assert call("", interrupt, capsys) == (
        130,
        "program work: interrupted: run.npz is complete\n",
    )


def test_ctrl_c_after_the_first_file_says_that_it_is_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.chdir(tmp_path)
    Path("it.json").write_text(LONG.replace({"duration": 0.1}).to_json())
    monkeypatch.setattr(c2d.Run, "to_html", interrupt)
    arguments = ["run", "it.json", "--save", "run.npz", "--html", "run.html"]
    assert main(arguments) == 130
    assert capsys.readouterr().err.endswith("interrupted: run.npz is complete\n")
    assert c2d.load("run.npz").has_history


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (c2d.ScenarioError("a", 1, "must\nbe b"), "a must be b, got 1"),
        (c2d.StoreError("a.sqlite is damaged"), "a.sqlite is damaged"),
        (ImportError("this needs x: pip install crawler2d[x]"), "this needs x: pip install"),
        (PermissionError(13, "Permission denied", "a.html"), "a.html: Permission denied"),
    ],
)
def test_an_error_is_one_line(
    error: Exception, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    status, err = call("", error, capsys)
    assert status == 2
    assert err.startswith(f"program work: {said}")
    assert len(err.splitlines()) == 1


def test_a_closed_pipe_is_no_error(tmp_path: Path) -> None:
    with started(tmp_path, "schema") as process:
        assert process.stdout is not None
        process.stdout.close()
        process.stdout = None
        _, err = process.communicate(timeout=30.0)
    assert (process.returncode, err) == (141, "")


def test_letters_that_an_output_lacks_are_no_error(tmp_path: Path) -> None:
    scenario = c2d.Scenario(ROBOT, c2d.terrains.step(0.05)).replace({"robot.name": "танк"})
    (tmp_path / "it.json").write_text(scenario.to_json(), encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "crawler2d", "run", "it.json"],
        capture_output=True,
        cwd=tmp_path,
        env={**os.environ, "PYTHONIOENCODING": "cp1252", "PYTHONUTF8": "0"},
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, b"")
    assert done.stdout.decode("cp1252").startswith(r"\u0442\u0430\u043d\u043a, belt, step: cleared")
    assert "°" in done.stdout.decode("cp1252")


def test_files_are_written_whether_or_not_anyone_reads(tmp_path: Path) -> None:
    scenario = c2d.Scenario(ROBOT, c2d.terrains.step(0.05))
    (tmp_path / "it.json").write_text(scenario.to_json())
    with started(tmp_path, "run", "it.json", "--save", "run.npz") as process:
        assert process.stdout is not None
        process.stdout.close()
        process.stdout = None
        _, err = process.communicate(timeout=30.0)
    assert (process.returncode, err) == (141, "")
    assert c2d.load(tmp_path / "run.npz").scenario == scenario


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no such device")
def test_an_output_that_is_full_is_one_line(tmp_path: Path) -> None:
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "crawler2d", "schema"],
            cwd=tmp_path,
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert done.returncode == 2
    assert done.stderr == "crawler2d schema: standard output: No space left on device\n"


def test_a_working_folder_that_is_gone_is_named_not_the_output(tmp_path: Path) -> None:
    (tmp_path / "run.json").write_text(LONG.to_json(), encoding="utf-8")
    program = "import os, sys; os.rmdir(os.getcwd()); from crawler2d.__main__ import main"
    (tmp_path / "gone").mkdir()
    done = subprocess.run(
        [sys.executable, "-c", f"{program}; sys.exit(main())", "run", "../run.json"],
        cwd=tmp_path / "gone",
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "crawler2d run: working folder: No such file or directory\n"


@pytest.mark.parametrize("option", ["--help", "--version"])
def test_help_and_version_go_to_the_standard_output(option: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "crawler2d", option],
        env={**os.environ, "COLUMNS": "80"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stderr == ""
    assert max(map(len, done.stdout.splitlines())) <= 80
    info = c2d.build_info()
    if option == "--version":
        (line,) = done.stdout.splitlines()
        assert line.startswith(f"crawler2d {info['version']}, core {info['build_id']} (release,")


def test_ctrl_c_ends_the_import_of_the_command_in_one_line(tmp_path: Path) -> None:
    """A numpy that imports slowly imitates a slow disc."""
    (tmp_path / "numpy.py").write_text("print(flush=True); import time; time.sleep(60.0)")
    with started(tmp_path, "demo") as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "\n"
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30.0)
    assert (process.returncode, out, err) == (130, "", "crawler2d: interrupted\n")


def test_ctrl_c_is_an_exception_for_programs_that_import_the_package() -> None:
    program = "import signal, crawler2d; print(signal.getsignal(signal.SIGINT).__name__)"
    done = subprocess.run(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, text=True, check=True
    )
    assert done.stdout == "default_int_handler\n"
