"""The page of a run, without a browser: its content, and that it is harmless."""

import base64
import hashlib
import html
import json
from collections.abc import Callable
from html.parser import HTMLParser
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d import _core
from crawler2d.drawings.scene import inset
from crawler2d.pictures.page.recording import MOST_FRAMES, pack
from tests.pictures.reading import unpacked
from tests.shared import GEAR, ROBOT, VARIANTS

HOSTILE = "</script><img src=x onerror=alert(1)> $data ${title} \"' & <!-- ]]> \u2028"
WHEELS = ROBOT.with_track(c2d.LineOfWheels(4, wheel_radius=0.0608))
GEARS = ROBOT.with_track(c2d.LineOfWheels(4, wheel_radius=0.0608, wheel=GEAR))


@pytest.fixture(scope="module")
def stopped() -> c2d.Run:
    return c2d.simulate(WHEELS, c2d.terrains.step(0.075), duration=4.0)


class Page(HTMLParser):
    """Tags with their attributes, and the text inside each."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.texts: dict[str, str] = {}
        self._open = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        self._open = f"{tag}#{dict(attrs).get('id')}" if dict(attrs).get("id") else tag

    def handle_endtag(self, tag: str) -> None:  # noqa: ARG002
        self._open = ""

    def handle_data(self, data: str) -> None:
        self.texts[self._open] = self.texts.get(self._open, "") + data

    @property
    def shown(self) -> str:
        hidden = ("style", "script", "script#recording")
        return "".join(text for tag, text in self.texts.items() if tag not in hidden)

    @property
    def recording(self) -> dict[str, Any]:
        def refuse(name: str) -> None:
            raise AssertionError(f"{name} is no JSON")

        found: dict[str, Any] = json.loads(self.texts["script#recording"], parse_constant=refuse)
        return found


def test_the_page_needs_nothing_from_outside(stopped: c2d.Run) -> None:
    text = stopped.to_html()
    assert text.startswith("<!doctype html>")
    assert "http" not in text.replace("http-equiv", "")
    assert not [word for word in ("@import", "url(", "fetch(", "import(", "//cdn") if word in text]
    for _, attributes in Page(text).tags:
        assert not {"src", "srcset", "action", "data", "style"} & set(attributes)
        assert attributes.get("href", "data:,") == "data:,"


def test_the_policy_of_the_page_lets_its_own_script_run_and_nothing_else(stopped: c2d.Run) -> None:
    page = Page(stopped.to_html())
    (policy,) = [a["content"] for tag, a in page.tags if tag == "meta" and "http-equiv" in a]
    assert policy is not None
    assert policy.startswith("default-src 'none'; img-src data:;")
    for name in ("style", "script"):
        digest = hashlib.sha256(page.texts[name].encode()).digest()
        assert f"{name}-src 'sha256-{base64.b64encode(digest).decode()}'" in policy
    assert not [name for _, a in page.tags for name in a if name.startswith("on")]


def test_the_page_says_what_the_run_says(stopped: c2d.Run) -> None:
    page = Page(stopped.to_html())
    assert page.texts["title"] == stopped.title
    assert str(stopped.diagnosis) in page.shown
    verdicts = [a["class"] for tag, a in page.tags if tag == "li" and "class" in a]
    assert verdicts == [f"outcome {stopped.outcome}", "mechanism"]
    assert f"{1e3 * stopped.metrics['intrusion_depth']:.1f} mm" in page.shown
    assert f"{stopped.metrics['drive_work']:.6g} J" in page.shown
    assert c2d.__version__ in page.shown


def test_a_goal_that_is_not_reached_is_reached_never(stopped: c2d.Run) -> None:
    page = stopped.to_html()
    after = page.split("time_to_clear", 1)[1]
    assert Page(after).shown.split()[0].startswith("never")
    assert ">inf" not in page


def test_the_page_holds_the_history_to_a_hundredth_of_a_millimetre(stopped: c2d.Run) -> None:
    recording = Page(stopped.to_html()).recording
    frames = recording["frames"]
    for name, values, tolerance in (
        ("time", stopped.time, 1e-4),
        ("x", stopped.position[:, 0], 1e-5),
        ("y", stopped.position[:, 1], 1e-5),
        ("angle", stopped.chassis_angle, 1e-4),
        ("speed", stopped.track_speed, 1e-4),
    ):
        assert np.abs(unpacked(frames[name]) - values).max() < tolerance, name
    contacts, table = recording["contacts"], stopped.contacts
    counts = np.rint(unpacked(contacts["counts"]))
    assert counts.tolist() == [np.count_nonzero(table["time"] == time) for time in stopped.time]
    assert np.abs(unpacked(contacts["x"]) - table["x"]).max() < 1e-5
    weight = stopped.scenario.robot.mass * stopped.scenario.gravity
    for name in ("normal_force", "friction_force"):
        assert np.abs(unpacked(contacts[name]) - table[name]).max() < 0.01 * weight, name
    angle = unpacked(contacts["normal"])
    assert np.abs(np.cos(angle) - table["normal_x"]).max() < 1e-4


@pytest.mark.parametrize("scenario", VARIANTS.values(), ids=VARIANTS)
def test_every_kind_of_robot_and_ground_has_a_page(scenario: c2d.Scenario) -> None:
    run = c2d.simulate(scenario.replace({"duration": 1.5}))
    recording = Page(run.to_html()).recording
    assert recording["frames"]["count"] == run.time.size
    (chassis, *_) = recording["robot"]["carriers"]
    # Nothing gets inside closed carriers, and only a belt moves grousers.
    looks = {body["look"] for body in chassis["bodies"]}
    closed = looks & {"hull", "guide", "shoe"}
    assert bool(chassis["envelope"]) is not bool(closed)
    assert bool(chassis["circuit"]) is (looks >= {"inside", "hull"})
    corners = sum(len(lane["corners"]) for lane in recording["ground"]["lanes"])
    # Nothing rolls on the belly's.
    assert corners == np.count_nonzero(run.edges["lane"] != c2d.Lane.MIDDLE)


def test_wheels_that_turn_alike_are_sent_once() -> None:
    """One motor, and one a wheel before a step that only the first meets."""
    columns = []
    for sharing in ("track", "wheel"):
        scenario = c2d.Scenario(WHEELS, c2d.terrains.step(0.075), duration=4.0)
        run = c2d.simulate(scenario.replace({"robot.drivetrain.torque_sharing": sharing}))
        columns.append(len(Page(run.to_html()).recording["robot"]["columns"]))
    assert columns == [1, 4]


def test_the_belt_round_wheels_comes_from_the_core(stopped: c2d.Run) -> None:
    geometry = _core.geometry(stopped.scenario.to_json())["carriers"][0]
    (chassis,) = Page(stopped.to_html()).recording["robot"]["carriers"]
    assert np.allclose(unpacked(chassis["envelope"]), geometry["envelope"].ravel(), atol=1e-5)
    assert chassis["root"] is None
    inner = unpacked(chassis["inner"]).reshape(-1, 2)
    radius = geometry["circles"][0, 2] - stopped.scenario.criteria.intrusion_depth
    assert inner[:, 1].max() == pytest.approx(radius, abs=1e-5)


def test_the_belt_round_the_roots_of_gears_runs_below_that_round_their_tips() -> None:
    run = c2d.simulate(GEARS, c2d.terrains.flat(), duration=0.5)
    (chassis,) = Page(run.to_html()).recording["robot"]["carriers"]
    top, root = (unpacked(chassis[name])[1::2].max() for name in ("envelope", "root"))
    assert top - root == pytest.approx(GEAR.grouser_height, abs=1e-5)


def test_an_inset_line_lies_inside_by_its_depth() -> None:
    angles = np.linspace(0.0, 2.0 * np.pi, 181)
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    moved = inset([1.0, 2.0] + 0.5 * circle, 0.1)
    assert np.hypot(*(moved - [1.0, 2.0]).T) == pytest.approx(0.4, abs=1e-12)


@pytest.mark.parametrize(
    "robot",
    [
        GEARS,
        ROBOT.with_track(c2d.CircumferentialWheels(24, wheel=c2d.GearWheel(grouser_count=8))),
    ],
    ids=["line", "circumferential"],
)
def test_fifteen_seconds_take_less_than_500_kb(
    robot: c2d.Robot, say: Callable[[str], None]
) -> None:
    # The criteria keep it running to the end, and each wheel has its own motor.
    scenario = c2d.Scenario(robot, c2d.terrains.step(0.1)).replace(
        {
            "criteria.stationary_distance": 1e-12,
            "criteria.stationary_windows": 100,
            "robot.drivetrain.torque_sharing": "wheel",
        }
    )
    run = c2d.simulate(scenario)
    assert run.time.size == 1501
    size = len(run.to_html().encode())
    say(f"a page of 15 s with {len(run.contacts)} contacts has {size / 1e3:.0f} kB")
    assert size < 500_000


@pytest.mark.filterwarnings("ignore:goal cannot be reached:crawler2d.ScenarioWarning")
def test_a_long_run_is_thinned_and_the_page_says_so() -> None:
    run = c2d.simulate(ROBOT, c2d.terrains.flat(), duration=4.0, sample_interval=1e-3, goal=1e3)
    assert run.time.size > MOST_FRAMES
    page = Page(run.to_html())
    frames = page.recording["frames"]
    time = unpacked(frames["time"])
    assert frames["count"] == len(time) <= MOST_FRAMES + 1
    assert time[-1] == pytest.approx(run.time[-1], abs=1e-4)
    assert f"1 in 2 samples shown, {run.time.size} in all" in page.shown
    assert "samples shown" not in c2d.simulate(ROBOT, c2d.terrains.flat(), duration=1.0).to_html()


@pytest.mark.parametrize(
    "name", [HOSTILE, "</TITLE><script>alert(1)</script>", "", "rouge-gorge é"]
)
def test_a_name_is_only_ever_text(name: str) -> None:
    scenario = c2d.Scenario(WHEELS, c2d.terrains.flat(), duration=0.5)
    plain = c2d.simulate(scenario)
    run = c2d.simulate(scenario.replace({"robot.name": name}))
    page = Page(run.to_html())
    assert page.tags[3:] == Page(plain.to_html()).tags[3:]
    assert page.texts["title"] == run.title
    assert page.recording["frames"] == Page(plain.to_html()).recording["frames"]


def test_the_page_is_written_to_a_file(stopped: c2d.Run, tmp_path: Path) -> None:
    path = tmp_path / "run.html"
    assert stopped.to_html(path) == path
    assert stopped.to_html(str(path)) == path
    assert path.read_text(encoding="utf-8") == stopped.to_html()
    assert list(tmp_path.iterdir()) == [path]


def test_a_failed_write_of_a_page_is_an_oserror(stopped: c2d.Run, tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        stopped.to_html(tmp_path / "missing" / "run.html")
    with pytest.raises(OSError, match="irectory"):
        stopped.to_html(tmp_path)
    assert not list(tmp_path.iterdir())


def test_a_stop_opens_at_its_end_and_other_runs_at_their_beginning(
    stopped: c2d.Run, run: c2d.Run
) -> None:
    assert Page(stopped.to_html()).recording["first"] == stopped.time.size - 1
    assert Page(run.to_html()).recording["first"] == 0
    assert Page(run.to_html(time=0.5)).recording["first"] == np.abs(run.time - 0.5).argmin()


def test_a_run_without_history_has_no_page() -> None:
    scenario = c2d.Scenario(ROBOT, c2d.terrains.flat(), duration=0.5)
    run = c2d.simulate(scenario, record="summary")
    with pytest.raises(AttributeError, match="record='summary'"):
        run.to_html()


def test_a_run_of_one_sample_without_contacts_has_a_page() -> None:
    run = c2d.simulate(ROBOT, c2d.terrains.flat(), duration=0.0, gravity=0.0)
    recording = Page(run.to_html()).recording
    assert recording["frames"]["count"] == run.time.size == 1
    assert not unpacked(recording["contacts"]["counts"]).any()


def test_a_notebook_shows_the_page_in_a_frame_that_can_only_run_scripts(
    stopped: c2d.Run,
) -> None:
    (tag, attributes), *rest = Page(stopped._repr_html_()).tags
    assert (tag, rest) == ("iframe", [])
    assert attributes["sandbox"] == "allow-scripts"
    assert attributes["title"] == stopped.title
    assert attributes["srcdoc"] == stopped.to_html()


def test_a_notebook_shows_the_figures_of_a_run_without_history() -> None:
    scenario = c2d.Scenario(ROBOT, c2d.terrains.flat(), duration=0.5)
    run = c2d.simulate(scenario.replace({"robot.name": HOSTILE}), record="summary")
    page = Page(run._repr_html_())
    assert not {"iframe", "img", "script"} & {tag for tag, _ in page.tags}
    assert html.escape(run.title) in run._repr_html_()
    assert "drive_work" in page.shown


def test_a_notebook_shows_a_run_that_failed() -> None:
    scenario = c2d.Scenario(ROBOT, c2d.terrains.flat())
    error = c2d.ScenarioError("robot.mass", "<b>\ud800", "must be > 0")
    text = c2d.Run(scenario, {}, error)._repr_html_()
    text.encode()
    assert "must be &gt; 0" in text
    assert "<b>" not in text


def test_packed_numbers_come_back() -> None:
    for values in ([], [1.0], [0.5, 0.5], [-3.0, 0.0, 2.0], [1e9, 1e9 + 1.0]):
        assert np.allclose(unpacked(pack(values, 1e-3)), values, atol=1e-3)
    broken = unpacked(pack([np.nan, np.inf, -np.inf, 1.0], 1e-3))
    assert np.array_equal(broken, [np.nan, np.inf, -np.inf, 1.0], equal_nan=True)


def test_the_parts_of_the_page_are_in_the_package() -> None:
    names = {path.name for path in files("crawler2d.pictures.page").iterdir()}
    assert {"page.html", "replay.css", "replay.js", "data.js", "scene.js"} <= names
