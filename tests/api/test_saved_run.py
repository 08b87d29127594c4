"""Saved runs load with the same bits, and other files are refused."""

import json
import pickle
import random
import zipfile
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.common.files import write_text
from crawler2d.runs.dataset import UNITS
from tests.shared import ROBOT, VARIANTS, refused

WHEELS = ROBOT.with_track(c2d.LineOfWheels(4, wheel_radius=0.0608))


@pytest.fixture(scope="module")
def stopped() -> c2d.Run:
    return c2d.simulate(WHEELS, c2d.terrains.step(0.075))


@pytest.fixture
def saved(stopped: c2d.Run, tmp_path: Path) -> Path:
    return stopped.save(tmp_path / "run.npz")


def same(one: Any, other: Any) -> bool:
    """Whether two values are equal, bit by bit."""
    if isinstance(one, np.ndarray):
        bits = one.tolist() == other.tolist() if one.dtype == object else _bits(one) == _bits(other)
        return one.dtype == other.dtype and one.shape == other.shape and bits
    if isinstance(one, Mapping):
        return list(one) == list(other) and all(same(one[name], other[name]) for name in one)
    if isinstance(one, (tuple, list)):
        return type(one) is type(other) and all(map(same, one, other))
    return type(one) is type(other) and repr(one) == repr(other)


def _bits(array: Any) -> bytes:
    return bytes(array.tobytes())


def content(run: c2d.Run) -> tuple[Any, ...]:
    """All contents of a run, as for pickling."""
    _, (scenario, result, error, parent) = run.__reduce__()
    return scenario.to_json(), result, error, parent


def reloaded(run: c2d.Run, folder: Path) -> c2d.Run:
    return c2d.load(run.save(folder / "a run.npz"))


def test_bits_that_differ_are_seen() -> None:
    assert not same(np.array([0.0]), np.array([-0.0]))
    assert not same({"a": (1, 2.0)}, {"a": (1, 2)})
    assert same({"a": (np.array([np.nan]), float("nan"))}, {"a": (np.array([np.nan]), np.nan)})


@pytest.mark.parametrize("record", ["full", "summary"])
@pytest.mark.parametrize("scenario", VARIANTS.values(), ids=VARIANTS)
def test_a_saved_run_loads_with_the_same_bits(
    scenario: c2d.Scenario, record: Any, tmp_path: Path
) -> None:
    run = c2d.simulate(scenario.replace({"duration": 2.0}), record=record)
    again = reloaded(run, tmp_path)
    assert again.scenario == run.scenario
    assert same(content(again), content(run))
    assert again.has_history is (record == "full")


def test_a_saved_stop_says_what_it_said(stopped: c2d.Run, tmp_path: Path) -> None:
    again = reloaded(stopped, tmp_path)
    assert again.outcome is c2d.Outcome.SEIZED
    assert str(again.diagnosis) == str(stopped.diagnosis)
    assert again.reason == stopped.reason
    assert again.mechanism is stopped.mechanism
    assert repr(again) == repr(stopped)
    assert same(content(again), content(stopped))


def test_a_loaded_run_does_what_a_run_does(stopped: c2d.Run, tmp_path: Path) -> None:
    again = reloaded(stopped, tmp_path)
    for name in UNITS:
        assert same(getattr(again, name), getattr(stopped, name))
        assert not getattr(again, name).flags.writeable
    assert same(again.poses, stopped.poses)
    assert again.to_html() == stopped.to_html()
    assert again._repr_html_() == stopped._repr_html_()
    belt = again.branch(track=c2d.BeltTrack())
    assert belt.metrics == stopped.branch(track=c2d.BeltTrack()).metrics
    assert again.what_if("torque x 2").freed is False
    assert pickle.loads(pickle.dumps(again)).metrics == stopped.metrics


def test_a_loaded_run_is_drawn_and_exported(stopped: c2d.Run, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    xarray = pytest.importorskip("xarray")
    again = reloaded(stopped, tmp_path)
    assert again.plot().get_xlabel() == stopped.plot().get_xlabel()
    assert len(again.plot_history()) == 3
    xarray.testing.assert_identical(again.to_xarray(), stopped.to_xarray())


def test_a_loaded_summary_says_that_it_has_no_history(stopped: c2d.Run, tmp_path: Path) -> None:
    again = reloaded(c2d.simulate(stopped.scenario, record="summary"), tmp_path)
    with pytest.raises(AttributeError, match="record='summary'"):
        again.to_html()
    assert again.metrics == stopped.metrics


def test_a_branch_is_loaded_with_its_parent(stopped: c2d.Run, tmp_path: Path) -> None:
    branch = stopped.branch(friction=2.0)
    again = reloaded(branch, tmp_path)
    assert again.parent == branch.parent
    assert same(content(again), content(branch))
    with pytest.raises(c2d.ScenarioError, match="must not be a branch or a run"):
        again.branch()


def test_a_run_without_result_is_not_saved(tmp_path: Path) -> None:
    scenario = c2d.Scenario(ROBOT, c2d.terrains.step(-1.0))
    (run,) = c2d.simulate_many([scenario], on_error="record")
    with pytest.raises(c2d.ScenarioError, match="must have a result to be saved"):
        run.save(tmp_path / "run.npz")
    assert not list(tmp_path.iterdir())


def test_a_run_names_the_build_that_simulated_it(stopped: c2d.Run, tmp_path: Path) -> None:
    assert stopped.build == reloaded(stopped, tmp_path).build == c2d.build_info()


def test_runs_of_this_build_share_one_build_record(stopped: c2d.Run, tmp_path: Path) -> None:
    other = c2d.simulate(WHEELS, c2d.terrains.flat(), duration=0.0)
    copies = (other, pickle.loads(pickle.dumps(stopped)), reloaded(stopped, tmp_path))
    assert all(run.build is stopped.build for run in copies)
    shared: Any = stopped.build
    with pytest.raises(TypeError):
        shared["version"] = "0"


def test_a_run_of_another_build_is_not_repeated_by_this_one(saved: Path) -> None:
    change(saved, lambda about: about["build"].update(build_id="an earlier one"))
    again = c2d.load(saved)
    for call in (again.branch, again.trials, again.escape_force):
        with pytest.raises(c2d.ScenarioError, match=r"not of an earlier one, .*simulate\(run\."):
            call()
    assert again.to_html()


def test_a_fall_in_another_build_is_not_explained_by_one_in_this(tmp_path: Path) -> None:
    saved = c2d.simulate(ROBOT, c2d.terrains.step(0.11)).save(tmp_path / "fall.npz")
    change(saved, lambda about: about["build"].update(build_id="an earlier one"))
    again = c2d.load(saved)
    assert again.reason == "tipped over backwards after 2.61 s"
    with pytest.raises(c2d.ScenarioError, match="not of an earlier one"):
        again.tip_over()


def test_page_and_data_set_of_a_run_name_its_build(saved: Path) -> None:
    change(saved, lambda about: about["build"].update(version="0.0.9", build_id="an earlier one"))
    again = c2d.load(saved)
    assert f"crawler2d 0.0.9, scenario {again.scenario.identity[:16]}" in again.to_html()
    attributes = again.to_xarray().attrs
    assert {name: attributes[f"build_{name}"] for name in again.build} == again.build


def test_a_run_that_has_not_stopped_when_its_file_says_so_is_not_continued(saved: Path) -> None:
    stop = json.loads(entry(saved, "diagnosis")) | {"time": 0.1}
    rewrite(saved, diagnosis=json.dumps(stop))
    again = c2d.load(saved)
    error = refused(lambda: again.what_if(track=c2d.BeltTrack()))
    assert (error.path, error.rule) == ("run", "must have stopped")


def entry(path: Path, name: str) -> str:
    """Return a text of a file."""
    with np.load(path) as entries:
        return str(entries[name])


def rewrite(path: Path, **changed: Any) -> None:
    """Change entries of a file."""
    with np.load(path) as entries:
        arrays: dict[str, Any] = {name: entries[name] for name in entries.files}
    np.savez_compressed(path, allow_pickle=True, **arrays | changed)


def change(path: Path, edit: Any) -> None:
    """Change the header of a file."""
    about = json.loads(entry(path, "about"))
    edit(about)
    rewrite(path, about=json.dumps(about))


def refusal(path: Path) -> str:
    """The error for a file: one line, with its path."""
    with pytest.raises(c2d.StoreError) as caught:
        c2d.load(path)
    text = str(caught.value)
    assert str(path) in text
    assert "\n" not in text
    return text


def test_a_file_that_is_no_saved_run_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "it.npz"
    assert "cannot be read: No such file" in refusal(path)
    assert "cannot be read: Is a directory" in refusal(tmp_path)
    for text in (b"", b"PK", b'{"robot": {}}', pickle.dumps([1])):
        path.write_bytes(text)
        assert "is not a saved run: Run.save writes them" in refusal(path)
    np.savez(path, position=np.zeros(3))
    assert "is not a saved run" in refusal(path)
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("about", "text")
    assert "is not a saved run" in refusal(path)


def test_the_error_for_a_newer_format_says_what_helps(saved: Path) -> None:
    change(saved, lambda about: about.update(version=2))
    assert "is of format 2, of crawler2d 0." in refusal(saved)
    assert "update crawler2d" in refusal(saved)


def test_a_scenario_that_is_refused_by_now_is_named(saved: Path) -> None:
    rewrite(saved, scenario=entry(saved, "scenario").replace('"gravity":9.81', '"gravity":-9.81'))
    assert "has a scenario that this crawler2d refuses" in refusal(saved)
    assert "gravity must be >= 0" in refusal(saved)


class Hostile:
    """Writes a file when it is unpickled."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self) -> Any:
        return Path.write_text, (self.path, "executed")


def test_nothing_in_a_file_is_executed(saved: Path) -> None:
    executed = saved.with_name("executed")
    hostile = np.array([Hostile(executed)], dtype=object)
    rewrite(saved, **{"trace/position": hostile})
    assert "is damaged" in refusal(saved)
    assert not executed.exists()
    with np.load(saved, allow_pickle=True) as entries:  # the file that would have been written
        entries["trace/position"]
    assert executed.exists()


def test_a_file_that_is_cut_short_is_refused(saved: Path) -> None:
    whole = saved.read_bytes()
    for part in range(5, len(whole), len(whole) // 40):
        saved.write_bytes(whole[:part])
        assert "is cut short or damaged: copy it again" in refusal(saved)


def test_a_flipped_byte_is_refused_or_changes_nothing(saved: Path, stopped: c2d.Run) -> None:
    whole, draw = saved.read_bytes(), random.Random(1)
    outcomes = []
    for _ in range(100):
        spoilt = bytearray(whole)
        spoilt[draw.randrange(len(whole))] ^= draw.randrange(1, 256)
        saved.write_bytes(spoilt)
        try:
            again = c2d.load(saved)
        except c2d.StoreError:
            outcomes.append("refused")
        else:
            outcomes.append("same")
            assert same(content(again), content(stopped))
    assert outcomes.count("refused") > 80


@pytest.fixture
def broken(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A disk that is full after a number of bytes."""

    def full(file: Any, **_: Any) -> None:
        file.write(b"PK")
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(np, "savez_compressed", full)
        yield


@pytest.mark.usefixtures("broken")
def test_a_failed_write_keeps_the_old_file(stopped: c2d.Run, tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    path.write_text("before")
    with pytest.raises(OSError, match="No space left") as caught:
        stopped.save(path)
    assert caught.value.filename == str(path)
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]


def test_a_run_is_written_under_the_name_given_and_replaces_what_is_there(
    stopped: c2d.Run, tmp_path: Path
) -> None:
    path, link = tmp_path / "run of today", tmp_path / "link"
    link.symlink_to(path)
    assert stopped.save(link) == link
    assert stopped.save(str(link)) == link
    assert link.is_symlink()
    assert c2d.load(path).metrics == stopped.metrics
    assert sorted(tmp_path.iterdir()) == [link, path]


def test_a_file_that_cannot_be_written_is_named_by_its_path(
    stopped: c2d.Run, tmp_path: Path
) -> None:
    with pytest.raises(FileNotFoundError) as caught:
        stopped.save(tmp_path / "missing" / "run.npz")
    assert caught.value.filename == str(tmp_path / "missing" / "run.npz")
    with pytest.raises(IsADirectoryError):
        stopped.save(tmp_path)
    assert not list(tmp_path.iterdir())


def test_a_run_is_not_written_under_the_suffix_of_another_format(
    stopped: c2d.Run, tmp_path: Path
) -> None:
    with pytest.raises(c2d.ScenarioError, match=r"path must end in \.npz") as caught:
        stopped.save(tmp_path / "run.txt")
    assert caught.value.value == "run.txt"
    assert not list(tmp_path.iterdir())
    for name in ("run.NPZ", "run"):
        assert c2d.load(stopped.save(tmp_path / name)).metrics == stopped.metrics


def test_threads_that_write_to_one_path_leave_one_of_their_files_whole(tmp_path: Path) -> None:
    texts = [letter * 100_000 for letter in "abcdefgh"]
    with ThreadPoolExecutor(8) as pool:
        for _ in range(10):
            list(pool.map(partial(write_text, tmp_path / "page.html"), texts))
            assert (tmp_path / "page.html").read_text() in texts
    assert [each.name for each in tmp_path.iterdir()] == ["page.html"]


def test_a_number_is_refused_as_the_path_of_a_run(tmp_path: Path) -> None:
    with (tmp_path / "other").open("wb") as file:
        with pytest.raises(TypeError):
            c2d.load(file.fileno())  # type: ignore[arg-type]
        file.write(b"still open")
        file.flush()
