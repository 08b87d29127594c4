"""`crawler2d run` and `crawler2d view`: arguments and output."""

import io
import json
from collections.abc import Callable
from pathlib import Path

import pytest

import crawler2d as c2d
from crawler2d.__main__ import main
from tests.shared import ROBOT

STEP = c2d.terrains.step(0.05)
WHEELS = ROBOT.with_track(c2d.LineOfWheels(4, wheel_radius=0.0608))
CLEARS = c2d.Scenario(ROBOT, STEP)
SEIZES = c2d.Scenario(WHEELS, c2d.terrains.step(0.075))

Ran = Callable[..., tuple[int, str, str]]


@pytest.fixture
def ran(capsys: pytest.CaptureFixture[str]) -> Ran:
    """Run a command line; return its exit status and output."""

    def call(*arguments: str) -> tuple[int, str, str]:
        try:
            status = main(arguments)
        except SystemExit as ended:
            status = ended.code if isinstance(ended.code, int) else -1
        printed = capsys.readouterr()
        return status, printed.out, printed.err

    return call


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working directory, with scenarios of two runs."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "clears.json").write_text(CLEARS.to_json())
    (tmp_path / "seizes now.json").write_text(SEIZES.to_json(indent=2))
    return tmp_path


@pytest.mark.usefixtures("folder")
def test_a_run_prints_how_it_ended_with_figures_and_units(ran: Ran) -> None:
    run = c2d.simulate(CLEARS)
    status, out, err = ran("run", "clears.json")
    assert (status, err) == (0, "")
    title, empty, *figures = out.splitlines()
    assert (title, empty) == (run.title, "")
    told = dict(line.rsplit("  ", 1) for line in figures)
    assert {name.strip(): value for name, value in told.items()}["motor work"] == (
        f"{run.metrics['drive_work']:.1f} J"
    )


@pytest.mark.usefixtures("folder")
def test_a_stop_is_printed_with_its_diagnosis_and_ends_with_1(ran: Ran) -> None:
    status, out, err = ran("run", "seizes now.json")
    assert (status, err) == (1, "")
    told = " ".join(out.split())
    assert str(c2d.simulate(SEIZES).diagnosis) in told
    assert "intrusion depth at the end" in told
    assert max(map(len, out.splitlines())) <= 80


@pytest.mark.parametrize(
    ("fields", "outcome"),
    [({"terrain.height": 0.12}, "tipped_over"), ({"duration": 0.5}, "timed_out")],
)
def test_a_run_that_does_not_clear_ends_with_1(
    folder: Path, ran: Ran, fields: dict[str, float], outcome: str
) -> None:
    (folder / "it.json").write_text(CLEARS.replace(fields).to_json())
    status, out, _ = ran("run", "it.json", "--json")
    assert (status, json.loads(out)["outcome"]) == (1, outcome)


@pytest.mark.usefixtures("folder")
def test_json_has_every_metric_with_its_unit_and_no_infinity(ran: Ran) -> None:
    run = c2d.simulate(SEIZES)
    _, out, _ = ran("run", "seizes now.json", "--json")

    def refuse(name: str) -> None:
        raise AssertionError(f"{name} is no JSON")

    told = json.loads(out, parse_constant=refuse)
    assert told["scenario"] == SEIZES.identity
    assert told["reason"] == str(run.diagnosis)
    assert told["build"] == c2d.build_info()
    assert list(told["metrics"]) == list(run.metrics)
    assert told["metrics"]["drive_work"] == {"value": run.metrics["drive_work"], "unit": "J"}
    assert told["metrics"]["time_to_clear"] == {"value": None, "unit": "s"}


@pytest.mark.usefixtures("folder")
def test_a_run_is_written_and_viewed_again(folder: Path, ran: Ran) -> None:
    status, out, _ = ran("run", "seizes now.json", "--html", "a b.html", "--save", "a b.npz")
    assert status == 1
    assert out.splitlines()[-2:] == ["written: a b.npz", "written: a b.html"]
    assert c2d.load("a b.npz").metrics == c2d.simulate(SEIZES).metrics
    assert ran("view", "a b.npz") == (
        0,
        f"{c2d.load('a b.npz').title}\nThe page is in {Path('out/a b.html')}\n",
        "",
    )
    assert (folder / "out/a b.html").read_text() == (folder / "a b.html").read_text()


@pytest.mark.usefixtures("folder")
def test_a_scenario_is_simulated_to_be_viewed(ran: Ran) -> None:
    status, out, err = ran("view", "clears.json", "--out", "here.html")
    assert (status, err) == (0, "")
    assert out.splitlines()[-1] == "The page is in here.html"
    assert Path("here.html").read_text() == c2d.simulate(CLEARS).to_html()


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize("command", ["run", "view"])
def test_a_scenario_may_come_from_the_standard_input(
    ran: Ran, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    text = io.TextIOWrapper(io.BytesIO(b"\xef\xbb\xbf" + CLEARS.to_json().encode()))
    monkeypatch.setattr("sys.stdin", text)
    status, out, _ = ran(command, "-")
    assert (status, out.splitlines()[0]) == (0, c2d.simulate(CLEARS).title)


@pytest.mark.usefixtures("folder")
def test_a_saved_run_may_come_from_the_standard_input(
    ran: Ran, monkeypatch: pytest.MonkeyPatch
) -> None:
    saved = c2d.simulate(CLEARS).save("saved.npz").read_bytes()
    for data, expected in ((saved, 0), (saved[:-40], 2)):
        monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(data)))
        status, out, err = ran("view", "-")
        assert status == expected
        assert out.splitlines()[:1] == ([c2d.load("saved.npz").title] if status == 0 else [])
        assert ("- is cut short or damaged" in err) == (status == 2)


def write_bad_files(folder: Path) -> None:
    """Write files that are not scenarios, or invalid ones."""
    (folder / "folder.json").mkdir()
    text = CLEARS.to_json()
    c2d.simulate(CLEARS, record="summary").save(folder / "summary.npz")
    whole = c2d.simulate(CLEARS).save(folder / "whole.npz").read_bytes()
    for name, data in {
        "empty.json": b" \n",
        "cut.json": text[:-2].encode(),
        "lines.json": b'{\n"robot":\n',
        "latin.json": '{"robot": {"name": "é"}}'.encode("latin-1"),
        "negative.json": text.replace('"mass":', '"mass":-').encode(),
        "unknown.json": text.replace('"gravity"', '"gravitation"').encode(),
        "other.json": b'{"version": "2.1.0", "runs": []}',
        "model.json": b'<?xml version="1.0"?><robot/>',
        "cut.npz": whole[:-40],
        "other.npz": b"text",
    }.items():
        (folder / name).write_bytes(data)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ("run missing.json", "FILE must be a file that can be read (No such file or directory)"),
        ("run folder.json", "FILE must be a file that can be read (Is a directory)"),
        ("run empty.json", "as Scenario.to_json writes it, got empty.json; it is empty"),
        ("run cut.json", "scenario must be JSON (EOF while parsing a value at line 1"),
        ("run lines.json", "scenario must be JSON (EOF while parsing a value"),
        ("run latin.json", "got latin.json; it is not UTF-8 text"),
        ("run negative.json", "robot.mass must be >= 1e-12 kg and <= 1e12 kg, got -"),
        ("run unknown.json", "gravity must be given"),
        ("run model.json", "if it is a model file: crawler2d audit model.json"),
        ("run whole.npz", "if it is a saved run: crawler2d view whole.npz"),
        ("run clears.json --html no/a.html", "--html must be a file in a folder that exists"),
        ("run clears.json --save folder.json", "--save must be a file in a folder that exists"),
        ("run clears.json --save clears.json", "--save must differ from the input file"),
        ("run clears.json --save run.txt", "--save must end in .npz, the format of saved runs"),
        ("run other.json", "scenario must be what Scenario.to_json writes, with the keys schema"),
        ("run clears.json --html ./clears.json", "--html must differ from the input file"),
        ("run clears.json --html a --save ../{}/a", "--save must differ from --"),
        ("view whole.npz --out whole.npz", "--out must differ from the input file"),
        ("run clears.json --htlm a.html", "unknown option --htlm (did you mean --html?)"),
        ("run clears.json cut.json", "one argument too many: cut.json"),
        ("run", "the following arguments are required: FILE"),
        ("view missing.npz", "FILE must be a file that can be read (No such file or directory)"),
        ("view cut.npz", "cut.npz is cut short or damaged: copy it again"),
        ("view other.npz", "scenario must be JSON"),
        ("view summary.npz", "FILE must have a history"),
        ("view clears.json --out .", "--out must be a file in a folder that exists"),
        ("veiw clears.json", "unknown command veiw (did you mean view?)"),
    ],
)
def test_an_impossible_request_is_refused_in_one_line(
    folder: Path, ran: Ran, arguments: str, said: str
) -> None:
    write_bad_files(folder)
    before = sorted(folder.rglob("*"))
    status, out, err = ran(*arguments.format(folder.name).split())
    assert (status, out) == (2, "")
    assert len(err.splitlines()) == 1
    assert err.startswith("crawler2d")
    assert said in err
    assert sorted(folder.rglob("*")) == before


def test_a_page_without_a_place_is_refused_before_the_run_where_out_is_no_folder(
    folder: Path, ran: Ran, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "out").write_text("")
    monkeypatch.setattr("crawler2d.commands.view.simulate", lambda _: 1 / 0)
    status, out, err = ran("view", "clears.json")
    assert (status, out) == (2, "")
    assert err.startswith("crawler2d view: --out must be given, got None: out is not a writable")


@pytest.mark.usefixtures("folder")
def test_a_file_that_cannot_be_written_is_named(ran: Ran, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(part: Path, _: Path) -> None:
        raise OSError(28, "No space left on device", str(part))

    monkeypatch.setattr("crawler2d.common.files.Path.replace", full)
    status, out, err = ran("run", "clears.json", "--html", "page.html")
    assert status == 2
    assert out.splitlines()[0] == c2d.simulate(CLEARS).title  # its results are not lost
    assert err.splitlines() == ["crawler2d run: page.html: No space left on device"]
    assert not list(Path().glob("*.html"))
    assert not list(Path().glob(".*"))


@pytest.mark.filterwarnings("default::crawler2d.ScenarioWarning")
def test_a_warning_is_one_line_and_no_error(folder: Path, ran: Ran) -> None:
    (folder / "it.json").write_text(CLEARS.replace({"gravity": 60.0, "duration": 0.1}).to_json())
    status, _, err = ran("run", "it.json")
    assert status == 1
    lines = err.splitlines()
    assert lines[0].startswith("crawler2d run: warning: gravity is usually at most 30.000 m/s^2")
    assert not [line for line in lines if not line.startswith("crawler2d run: warning: ")]


@pytest.mark.usefixtures("folder")
def test_a_page_is_opened_in_the_browser(ran: Ran, monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []

    def open_(name: str) -> bool:
        opened.append(name)
        return True

    monkeypatch.setattr("webbrowser.open", open_)
    status, _, err = ran("view", "seizes now.json", "--open")
    assert (status, err) == (0, "")
    assert opened == [Path("out/seizes now.html").resolve().as_uri()]
    monkeypatch.setattr("webbrowser.open", lambda _: False)
    status, _, err = ran("view", "seizes now.json", "--open")
    assert status == 0
    assert "no browser was found: open" in err
