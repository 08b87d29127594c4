"""The command `crawler2d audit`: its output, files and exit status."""

import argparse
import dataclasses
import functools
import html
import importlib
import inspect
import json
import re
import shlex
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import pytest

import crawler2d as c2d
from crawler2d.__main__ import main
from crawler2d.audits.record import OPTIONS, Call, as_options, command_of
from crawler2d.audits.text import plain_of
from crawler2d.commands import audit as command
from tests.audits.seizing import instant_audit
from tests.reading.carts import FILES, WHEELS, pair, urdf

ROBOTS = Path(__file__).parent.parent / "robots"


def run(capsys: Any, *arguments: str) -> tuple[int, str, str]:
    status = main(["audit", *arguments])
    printed = capsys.readouterr()
    return status, printed.out, printed.err


@pytest.mark.usefixtures("one_obstacle")
def test_the_command_prints_the_short_form(capsys: Any) -> None:
    few = ("--samples", "2", "--repeats", "1", "--no-repairs", "--no-html")
    status, out, _ = run(capsys, str(FILES / "cart.urdf"), *few)
    assert status in (0, 1)
    assert out.startswith("cart: 3 round wheels in a line")
    assert "Verdicts: at most 2 samples of robot and floor, 1 run each" in out


@pytest.mark.usefixtures("one_obstacle")
def test_the_command_writes_json(capsys: Any) -> None:
    status, out, _ = run(
        capsys, str(FILES / "cart.urdf"), "--quick", "--samples", "1", "--json", "--no-html"
    )
    plain = json.loads(out)
    assert (status == 1) is plain["seizes"]
    assert plain["file"] == "cart.urdf"


@pytest.mark.parametrize(
    "arguments",
    [
        ["missing.sdf"],
        [str(FILES / "cart.urdf"), "--samples", "0"],
        [__file__],
        ["x", "--package", "a"],
    ],
)
def test_the_command_refuses_bad_input_in_one_line(capsys: Any, arguments: list[str]) -> None:
    status, out, err = run(capsys, *arguments)
    assert (status, out) == (2, "")
    assert len(err.strip().splitlines()) == 1


def test_what_is_no_baseline_is_refused_by_the_name_of_the_option(capsys: Any) -> None:
    file = str(FILES / "cart.urdf")
    status, out, err = run(capsys, file, "--baseline", file)
    assert (status, out) == (2, "")
    assert err.startswith("crawler2d audit: --baseline must be a file that --update-baseline wrote")


@pytest.mark.parametrize("place", [".", "no folder/store", "not a store"])
def test_a_wrong_store_is_refused_before_any_result(
    capsys: Any, monkeypatch: Any, tmp_path: Path, place: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "not a store").write_text("a text")
    status, out, err = run(capsys, str(FILES / "cart.urdf"), "--store", place)
    assert (status, out) == (2, "")
    assert err.startswith(f"crawler2d audit: {place} ")


def test_the_command_says_whether_it_seizes(
    capsys: Any, monkeypatch: Any, found: c2d.Audit
) -> None:
    monkeypatch.setattr(command, "audit", instant_audit(found))
    status, out, _ = run(capsys, "any.sdf", "--no-html")
    assert status == 1
    assert out.strip() == found.summary


@pytest.mark.parametrize(
    "interrupt", [KeyboardInterrupt, functools.partial(c2d.BatchInterrupted, [], "a.sqlite")]
)
def test_after_ctrl_c_the_command_says_what_is_kept(
    capsys: Any, monkeypatch: Any, interrupt: Callable[[], BaseException]
) -> None:
    monkeypatch.setattr(command, "audit", Mock(side_effect=interrupt()))
    status, _, err = run(capsys, "any.sdf", "--store", "a.sqlite")
    assert status == 130
    assert err.startswith("crawler2d audit: interrupted: a.sqlite keeps every finished run")
    monkeypatch.setattr(command, "audit", Mock(side_effect=interrupt()))
    status, _, err = run(capsys, "any.sdf")
    assert status == 130
    kept = "no run is kept; --store FILE keeps every finished run"
    assert err == f"crawler2d audit: interrupted: {kept}\n"


@pytest.fixture
def made(monkeypatch: Any, tmp_path: Path, found: c2d.Audit) -> Path:
    """An empty working directory, and an instant audit."""
    monkeypatch.setattr(command, "audit", instant_audit(found))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_command_writes_the_page_and_says_where(made: Path, capsys: Any) -> None:
    status, out, err = run(capsys, "models/any.sdf")
    assert (status, err) == (1, "")
    assert out.strip().endswith(f"The page is in {Path('out/audit-any.html')}")
    text = (made / "out" / "audit-any.html").read_text(encoding="utf-8")
    assert text.startswith("<!doctype html>")


def test_the_page_can_be_written_elsewhere_or_nowhere(made: Path, capsys: Any) -> None:
    run(capsys, "any.sdf", "--html", "here.html")
    assert [each.name for each in made.iterdir()] == ["here.html"]
    run(capsys, "any.sdf", "--no-html")
    assert [each.name for each in made.iterdir()] == ["here.html"]


def test_with_json_nothing_else_is_on_the_standard_output(made: Path, capsys: Any) -> None:
    _, out, err = run(capsys, "any.sdf", "--json")
    assert json.loads(out)["seizes"] is True
    page = Path("out/audit-any.html")
    assert err.strip().endswith(f"The page is in {page}")
    assert (made / page).is_file()


@pytest.mark.usefixtures("made")
@pytest.mark.parametrize("option", ["--html", "--patch", "--junit", "--sarif"])
@pytest.mark.parametrize("place", [".", "no folder/file"])
def test_an_unwritable_file_is_refused_before_the_audit(
    capsys: Any, option: str, place: str
) -> None:
    status, out, err = run(capsys, "any.sdf", option, place)
    assert (status, out) == (2, "")
    assert err.startswith(f"crawler2d audit: {option} must be a file in a folder that exists")


@pytest.mark.parametrize(
    ("options", "rule"),
    [
        ("--html any.sdf", "--html must differ from the input file"),
        ("--junit ./any.sdf", "--junit must differ from the input file"),
        ("--junit a --sarif a", "--sarif must differ from --junit"),
        ("--patch a --html a", "--html must differ from --patch"),
        ("--update-baseline --baseline a --html a", "--baseline must differ from --"),
        ("--baseline a --junit a", "--junit must differ from the input file"),
        ("--store a --html a", "--html must differ from the store"),
    ],
)
def test_no_file_takes_the_place_of_another_one(
    made: Path, capsys: Any, options: str, rule: str
) -> None:
    (made / "any.sdf").write_text("<sdf/>")
    status, out, err = run(capsys, "any.sdf", *options.split())
    assert (status, out) == (2, "")
    assert err.startswith(f"crawler2d audit: {rule}")
    assert [each.name for each in made.iterdir()] == ["any.sdf"]


@pytest.mark.usefixtures("made")
def test_the_changed_file_may_take_the_place_of_the_model(capsys: Any) -> None:
    _, out, err = run(capsys, "any.sdf", "--no-html", "--patch", "any.sdf")
    assert out
    assert "another file" not in err


def test_a_page_without_a_place_is_refused_before_the_audit_where_out_is_no_folder(
    made: Path, capsys: Any
) -> None:
    (made / "out").write_text("")
    status, out, err = run(capsys, "any.sdf")
    assert (status, out) == (2, "")
    assert err.startswith("crawler2d audit: --html must be given: out is not a writable folder")
    assert run(capsys, "any.sdf", "--no-html")[0] == 1


CALL = Call(samples=4, repeats=3, seed=2**63, repair=False)
HOWS: Any = [
    {},
    {"engine": "isaac", "forward": "-x", "model": "a b; rm -rf $HOME", "ground_friction": 0.7},
    {"mesh": "refuse", "missing": "refuse", "trusted": True},
    {"tracks": ["-left", "right"], "packages": {"a": "b=c"}, "arguments": {"n": "it's"}},
    {"tolerance": 0.01, "ground_friction": 0.5},
]


@pytest.mark.parametrize("how", HOWS)
def test_the_command_that_a_page_names_is_the_same_call(how: Any) -> None:
    call = Call(samples=4, repeats=3, seed=2**63, repair=False, reading=how)
    text = command_of(call, "-my file.sdf")
    assert text is not None
    program, name, *arguments = shlex.split(text)
    assert (program, name) == ("crawler2d", "audit")
    parser = argparse.ArgumentParser()
    command.add_arguments(parser)
    options = parser.parse_args(arguments)
    assert options.file == [Path("-my file.sdf")]
    assert (options.samples, options.repeats, options.seed) == (4, 3, 2**63)
    assert options.no_repairs
    kept = command._reading(options)
    assert {name: value for name, value in kept.items() if value} == {
        "mesh": "hull",
        "missing": "leave_out",
        "tolerance": 0.001,
        **how,
    }


def test_the_command_of_a_quick_audit_is_quick() -> None:
    assert "--quick" in str(command_of(dataclasses.replace(CALL, quick=True), "a.sdf")).split()
    assert "--quick" not in str(command_of(CALL, "a.sdf")).split()


def test_a_call_with_arguments_that_no_option_has_is_no_command() -> None:
    assert command_of(CALL, "a.sdf") is not None
    assert command_of(dataclasses.replace(CALL, own=("vary",)), "a.sdf") is None


@pytest.fixture
def expanding(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A xacro file, named relative to the folder above its own, which is the working directory."""
    pytest.importorskip("xacrodoc")
    (tmp_path / "models").mkdir()
    path = Path("models") / "cart.urdf.xacro"
    monkeypatch.chdir(tmp_path)
    path.write_text((FILES / "cart.xacro").read_text(encoding="utf-8"), encoding="utf-8")
    return path


@pytest.mark.usefixtures("one_obstacle")
def test_the_command_on_a_page_makes_the_same_audit_again(expanding: Path, capsys: Any) -> None:
    how: Any = {"trusted": True, "engine": "isaac", "tolerance": 0.01}
    few: Any = {"samples": 1, "repeats": 1, "repair": False, "progress": False}
    once = c2d.audit(expanding, **few, **how)
    command = re.search(r"crawler2d audit models.*?(?=<)", once.to_html())
    assert command is not None
    arguments = shlex.split(html.unescape(command[0]))[2:]
    status, out, err = run(capsys, *arguments, "--json", "--no-html")
    assert status in (0, 1), err
    assert json.loads(out) == json.loads(json.dumps(plain_of(once)))


@pytest.mark.usefixtures("one_obstacle")
def test_the_lines_of_xacro_are_those_of_a_file_beside_the_page(
    expanding: Path, capsys: Any
) -> None:
    few = ("--samples", "1", "--repeats", "1", "--no-repairs", "--trusted", "--json")
    status, out, err = run(capsys, str(expanding), *few)
    assert status in (0, 1)
    text = Path("out") / "audit-cart.urdf-expanded.urdf"
    assert err.strip().endswith(f"The lines are those of {text}")
    source = json.loads(out)["sources"]["robot.outline.front_radius"]
    line = int(re.search(r"expanded\):(\d+)", source)[1])  # type: ignore[index]
    assert "<cylinder" in text.read_text(encoding="utf-8").splitlines()[line - 1]
    page = (Path("out") / "audit-cart.urdf.html").read_text(encoding="utf-8")
    assert "lines are those of the text that cart.urdf.xacro expands to, Reading.text" in page


def test_the_command_advises_its_own_options(capsys: Any, tmp_path: Path) -> None:
    path = tmp_path / "cart.xacro"
    text = (FILES / "cart.xacro").read_text(encoding="utf-8")
    path.write_text(text.replace("${radius}", "${radius.real}"), encoding="utf-8")
    status, _, err = run(capsys, str(path))
    assert status == 2
    assert "--trusted" in err
    assert "trusted=True" not in err


@pytest.mark.parametrize("name", ["package://p/m.stl", "/m.stl"])
def test_the_command_advises_its_option_for_folders(capsys: Any, tmp_path: Path, name: str) -> None:
    path = tmp_path / "cart.urdf"
    wheels = pair("middle", 0.0, geometry=f'<mesh filename="{name}"/>')
    path.write_text(urdf(WHEELS, wheels), encoding="utf-8")
    status, _, err = run(capsys, str(path))
    assert status == 2
    assert "--package NAME=FOLDER" in err
    assert "packages=" not in err


def test_the_console_script_is_this_command(capsys: Any) -> None:
    project = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))["project"]
    module, _, name = project["scripts"]["crawler2d"].partition(":")
    script = getattr(importlib.import_module(module), name)
    assert script(["audit", "missing.sdf"]) == 2
    assert capsys.readouterr().err.startswith("crawler2d audit: FILE must be")


@pytest.mark.parametrize("forward", [["--forward", "-x"], ["--forward=-x"]])
def test_a_direction_may_begin_with_a_minus(capsys: Any, forward: list[str]) -> None:
    path = c2d.samples.path("rover.sdf")
    assert main(["audit", *forward, "--lint", str(path)]) == 0
    assert "is forward right?" in capsys.readouterr().out


def test_python_m_is_the_same_command() -> None:
    words = [sys.executable, "-m", "crawler2d", "audit", "missing.sdf"]
    made = subprocess.run(words, capture_output=True, text=True, check=False)
    assert (made.returncode, made.stdout) == (2, "")
    assert made.stderr.startswith("crawler2d audit: FILE must be")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--smaples", "3", "x.sdf"], "unknown option --smaples (did you mean --samples?)"),
        (["x.sdf", "--engine", "ode"], "invalid choice: 'ode'"),
        ([], "the following arguments are required: file"),
    ],
)
def test_a_misspelled_option_is_refused_in_one_line(
    capsys: Any, arguments: list[str], said: str
) -> None:
    with pytest.raises(SystemExit) as ended:
        run(capsys, *arguments)
    printed = capsys.readouterr()
    assert (ended.value.code, printed.out) == (2, "")
    assert len(printed.err.strip().splitlines()) == 1
    assert said in printed.err
    assert "crawler2d audit --help" in printed.err


@pytest.mark.parametrize("what", ["missing", "folder", "empty"])
def test_an_invalid_file_is_refused_in_one_line(capsys: Any, what: str) -> None:
    with tempfile.TemporaryDirectory() as folder:  # a long path is cut at its end
        path = Path(folder) / f"{what}.sdf"
        if what == "folder":
            path.mkdir()
        elif what == "empty":
            path.touch()
        status, out, err = run(capsys, str(path))
    assert (status, out) == (2, "")
    assert len(err.strip().splitlines()) == 1
    assert path.name in err
    assert ("crawler2d atlas" in err) == (what == "folder")


WITHOUT_OPTION = {"obstacles", "vary", "unknown", "drive", "duration", "executor", "progress"}
"""Of the keywords of an audit."""


def keywords() -> list[str]:
    """All keywords of `audit` and `read_robot`."""
    names = [
        *inspect.signature(c2d.audit).parameters,
        *inspect.signature(c2d.read_robot).parameters,
    ]
    others = {"robot", "reading", "path", "repair"}
    return [name for name in dict.fromkeys(names) if name not in WITHOUT_OPTION | others]


@pytest.mark.parametrize("name", keywords())
def test_errors_speak_of_options(name: str) -> None:
    parser = argparse.ArgumentParser()
    command.add_arguments(parser)
    option = OPTIONS[name]
    assert option in {each for action in parser._actions for each in action.option_strings}
    assert as_options(f"{name} must be given, got None") == f"{option} must be given"
    assert as_options(f"{name}['a'] must be text, got 3") == f"{option} must be text, got 3"
    for advice in (f"or {name}= says", f'or {name}="hull" says', f"or {name}=0.01 says"):
        expected = as_options(advice)
        assert expected.startswith(f"or {option} ")
        assert f"{name}=" not in expected
        assert expected.endswith(" says")


@pytest.mark.parametrize(
    ("advice", "expected"),
    [
        ("trusted=True lets it", "--trusted lets it"),
        ("packages={name: folder}", "--package NAME=FOLDER"),
        ("arguments={'a': 1} sets it", "--argument NAME=VALUE sets it"),
        ("tolerance= may say more", "--tolerance may say more"),
        ("a submodel=1 is none", "a submodel=1 is none"),
    ],
)
def test_advice_is_given_as_options(advice: str, expected: str) -> None:
    assert as_options(advice) == expected


def test_a_file_ten_times_too_large_is_refused_before_any_run(capsys: Any) -> None:
    """Otherwise another robot would be audited."""
    status, out, err = run(capsys, str(ROBOTS / "eng.urdf"), "--mesh", "leave_out")
    assert (status, out) == (2, "")
    assert "--scale must be given: eng.urdf is 5.32 m long" in err
    assert "if it is ten times too large, pass --scale 0.1" in err
    assert "--scale 1 leaves it as it is" in err
    assert len(err.strip().splitlines()) == 1
