"""The explorer as a visitor uses it: pictures, sliders, dots, links, keys, phones, both schemes."""

import contextlib
import io
import json
from typing import Any

import pytest
from playwright.sync_api import Page

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from explorer.page import begin
from tests.browser.seen import COLOURS, DRAWN, Open, checksum, clock, violations
from tests.explorer.conftest import settled

HEIGHT = "[id='field-terrain.height']"


def part(page: Page, which: str, number: int = 1) -> str:
    if which == "sentence":
        return str(page.text_content(f".sentences p:nth-child({number})"))
    return str(page.inner_text(f".pair figure:nth-child({number}) .{which}"))


def state(page: Page) -> Scenario:
    """Read the scenario that the page offers to copy."""
    page.click("#copy-json")
    return Scenario.from_json(page.input_value("#copied"))


def test_it_begins_with_the_case_of_the_readme(page: Page) -> None:
    run = c2d.simulate(begin())
    assert run.outcome == "seized"
    assert run.diagnosis is not None
    assert part(page, "subject") == begin().robot.track.description
    assert part(page, "ending") == f"seized at {run.diagnosis.since:.1f} s"
    assert part(page, "mechanism") == run.mechanism
    assert part(page, "sentence") == f"{run.diagnosis}."
    assert part(page, "subject", 2) == "smooth belt"
    assert part(page, "ending", 2).startswith("cleared after ")
    for canvas in page.locator("canvas").all():
        assert canvas.evaluate(COLOURS) > 20
    assert state(page) == begin()
    assert "#" not in page.url


def test_a_slider_changes_the_outcome(page: Page) -> None:
    before = checksum(page, ".pair figure:nth-child(1) canvas")
    page.fill(HEIGHT, "0.02")
    settled(page)
    assert part(page, "ending").startswith("cleared after ")
    assert checksum(page, ".pair figure:nth-child(1) canvas") != before
    assert page.get_attribute(HEIGHT, "aria-valuetext") == "20 mm"
    page.click("#start")
    settled(page)
    assert part(page, "ending").startswith("seized at ")


@pytest.mark.parametrize(
    ("handle", "move", "path", "sign"),
    [
        ("obstacle", (0, -30), "terrain.height", 1),
        ("wheel", (0, 15), "robot.track.wheel_radius", -1),
        ("axle", (20, 0), "robot.outline.axle_distance", 1),
        ("mass", (25, 0), "robot.center_of_mass[0]", 1),
    ],
)
def test_what_is_dragged_in_the_picture_changes_the_scenario(
    page: Page, handle: str, move: tuple[int, int], path: str, sign: int
) -> None:
    before = state(page).to_json()
    box = page.locator(f".handle.{handle}").bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + move[0], y + move[1], steps=8)
    page.mouse.up()
    settled(page)
    changes = float(page.input_value(f"[id='field-{path}']")) - value(before, path)
    assert sign * changes > 0.002


def value(text: str, path: str) -> float:
    found: Any = json.loads(text)
    for key in path.replace("]", "").replace("[", ".").split("."):
        found = found[int(key) if key.isdigit() else key]
    return float(found)


def test_the_newest_of_many_changes_is_shown(page: Page) -> None:
    page.evaluate(
        """([place, last]) => {
            const input = document.querySelector(place);
            for (let height = 0.05; height < 0.1; height += 0.001) {
                input.value = String(height);
                input.dispatchEvent(new Event("input"));
            }
            input.value = last;
            input.dispatchEvent(new Event("input"));
        }""",
        [HEIGHT, "0.03"],
    )
    page.wait_for_timeout(400)
    settled(page)
    run = c2d.simulate(begin().replace({"terrain.height": 0.03}))
    assert part(page, "ending") == f"cleared after {run.metrics['time_to_clear']:.1f} s"


def test_a_run_that_waits_for_a_slow_one_is_not_pushed_aside_by_trials(page: Page) -> None:
    page.evaluate(
        """async (place) => {
            const [{ core }] = window.explored.views;
            const input = document.querySelector(place);
            const held = [];
            const later = (ms) => new Promise((done) => setTimeout(done, ms));
            const release = async () => {
                while (!held.length) await later(10);
                core.take(held.shift());
                await later(0);
            };
            const send = (type, height) => {
                input.value = height;
                input.dispatchEvent(new Event(type));
            };
            core.worker.onmessage = ({ data }) => held.push(data);
            send("input", "0.08");
            await release(); // a stop that is not judged yet
            send("input", "0.085");
            send("input", "0.03");
            send("change", "0.03");
            await later(400); // by now stops would be tried
            core.worker.onmessage = ({ data }) => core.take(data);
            await release();
        }""",
        HEIGHT,
    )
    page.wait_for_timeout(400)
    settled(page)
    highest = """() => window.explored.views.map(({ scene }) =>
        Math.max(...scene.lanes.at(-1).edges.map(({ y }) => y)))"""
    assert page.evaluate(highest) == [0.03, 0.03]


def test_both_pictures_show_all_of_another_obstacle(page: Page) -> None:
    """A list reports a change and its end at once, long before the run has finished."""
    page.select_option("[id='field-terrain.kind']", "stairs")
    settled(page)
    views = page.evaluate(
        """() => window.explored.views.map(({ scene, camera }) =>
            [camera.right, camera.top, scene.drawing.extent[3], scene.drawing.ground.goal])"""
    )
    highest = max(top for _, _, top, _ in views)
    for right, top, _, goal in views:
        assert right > goal
        assert top == highest


def test_a_picture_of_a_belt_has_no_wheel_to_drag(page: Page) -> None:
    """It stays until the robot with wheels is simulated; an exception fails the test."""
    page.select_option("[id='field-robot.track.kind']", "grouser_belt")
    settled(page)
    page.evaluate("location.hash = 'robot.track.count=1'")
    page.wait_for_function(
        "() => document.querySelector('.ending').textContent === 'not simulated'"
    )
    page.evaluate(DRAWN)
    assert page.locator(".handle.axle").is_visible()
    assert not page.locator(".handle.wheel").is_visible()


def test_a_link_restores_the_state(page: Page, open_page: Open, html: str) -> None:
    page.select_option("[id='field-terrain.kind']", "barrier")
    page.select_option("[id='field-robot.track.wheel.kind']", "gear")
    page.fill("[id='field-robot.track.count']", "5")
    page.fill("[id='field-terrain.friction']", "0.5")
    settled(page)
    page.wait_for_function("() => location.hash.includes('terrain.friction=0.5')")
    expected, ending = state(page), part(page, "ending")
    other = open_page(html)
    other.evaluate("hash => { location.hash = hash; }", page.evaluate("location.hash"))
    settled(other)
    other.wait_for_function(
        "text => document.querySelector('.ending').textContent === text", arg=ending
    )
    assert state(other) == expected
    assert expected.robot.track == c2d.LineOfWheels(5, wheel_radius=0.0608, wheel=c2d.GearWheel())
    assert expected.terrain == c2d.terrains.barrier(0.06, 0.08, friction=0.5)


def test_an_invalid_link_opens_the_initial_state(page: Page) -> None:
    page.evaluate("location.hash = 'terrain.height=x&no.such=1&terrain.kind=moon&__proto__=1'")
    settled(page)
    assert state(page) == begin()


def test_the_python_that_is_copied_makes_the_scenario(page: Page) -> None:
    page.select_option("[id='field-robot.track.kind']", "circumferential")
    page.select_option("[id='field-terrain.kind']", "gap")
    page.fill("[id='field-robot.center_of_mass[1]']", "0.06")
    page.fill("[id='field-robot.outline.axle_distance']", "0.4")
    settled(page)
    expected = state(page)
    page.click("#copy-python")
    names: dict[str, Any] = {}
    with contextlib.redirect_stdout(io.StringIO()) as said:
        exec(page.input_value("#copied"), names)
    assert names["scenario"] == expected
    assert expected.robot.belly is not None
    assert max(expected.robot.belly)[0] == 0.2
    assert said.getvalue().strip() == (
        part(page, "sentence").rstrip(".") if names["run"].reason else "cleared"
    )


def test_a_broken_rule_is_named(page: Page) -> None:
    page.evaluate(
        "location.hash = 'robot.track.kind=circumferential&robot.track.wheel_radius=0.09'"
    )
    # A function, because the page forbids evaluating text, which waiting for an expression does.
    page.wait_for_function(
        "() => document.querySelector('.ending').textContent === 'not simulated'"
    )
    with pytest.raises(c2d.ScenarioError) as caught:
        begin().replace(
            {"robot.track": c2d.CircumferentialWheels(24, wheel_radius=0.09)}
        ).validate()
    assert part(page, "sentence") == str(caught.value)
    page.fill("[id='field-robot.track.wheel_radius']", "0.015")
    settled(page)
    assert part(page, "ending").startswith("seized at ")


def test_a_page_that_begins_with_a_broken_rule_says_so(asked: Page) -> None:
    asked.evaluate(
        "location.hash = 'robot.track.kind=circumferential&robot.track.wheel_radius=0.09'"
    )
    asked.reload()
    settled(asked)
    assert part(asked, "ending") == "not simulated"
    assert part(asked, "ending", 2).startswith("cleared after ")
    asked.fill("[id='field-robot.track.wheel_radius']", "0.015")
    settled(asked)
    assert part(asked, "ending").startswith("seized at ")
    assert asked.locator("canvas").first.evaluate(COLOURS) > 20


def test_the_keyboard_is_enough(page: Page) -> None:
    end = clock(page)
    page.focus("#scrub")
    page.keyboard.press("Home")
    assert clock(page) == 0.0
    page.focus(".pair canvas")
    page.keyboard.press("ArrowRight")
    assert clock(page) == 0.02
    page.keyboard.press("Space")
    page.wait_for_timeout(300)
    page.keyboard.press("Space")
    assert 0.05 < clock(page) < end
    page.keyboard.press("End")
    assert clock(page) == end
    page.focus(HEIGHT)
    page.keyboard.press("ArrowLeft")
    settled(page)
    assert value(state(page).to_json(), "terrain.height") == pytest.approx(0.074)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing(open_page: Open, html: str, scheme: str) -> None:
    page = open_page(html, color_scheme=scheme)
    settled(page)
    page.click("#copy-python")
    assert page.locator("input, select").count() > 15
    assert violations(page) == []


@pytest.mark.parametrize(("width", "height"), [(360, 740), (390, 844), (1000, 800), (1280, 800)])
def test_the_page_fits_every_width(page: Page, width: int, height: int) -> None:
    page.set_viewport_size({"width": width, "height": height})
    page.evaluate(DRAWN)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    boxes = [each.bounding_box() for each in page.locator("canvas").all()]
    assert all(box and box["y"] + box["height"] < height for box in boxes)
    # The pictures stay in view while the last slider is moved.
    page.locator("[id='field-drive.speed']").scroll_into_view_if_needed()
    if width < 600:
        box = page.locator("canvas").first.bounding_box()
        assert box is not None
        assert box["y"] >= 0


def test_nothing_moves_by_itself(page: Page) -> None:
    drawn = checksum(page, "canvas")
    page.wait_for_timeout(300)
    assert checksum(page, "canvas") == drawn
