"""The page of a run in a real browser: it opens and plays, and its controls work."""

import json
import re
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page

import crawler2d as c2d
from crawler2d.pictures.scenes import scene_of
from tests.browser.seen import CHECKSUM, COLOURS, DRAWN, Open, checksum, clock
from tests.shared import ROBOT, with_flippers

STEP = c2d.terrains.step(0.075)
LANES = c2d.terrains.lanes(c2d.terrains.step(0.05), c2d.terrains.step(0.03))
ROUND = c2d.LineOfWheels(4, wheel_radius=0.0608)
GEARED = c2d.LineOfWheels(4, wheel_radius=0.0608, wheel=c2d.GearWheel(grouser_count=12))
GEARED_ARMS = c2d.LineOfWheels(4, wheel_radius=0.037, wheel=c2d.GearWheel(grouser_count=12))
RING = c2d.CircumferentialWheels(24, wheel_radius=0.015)
SPROCKET = c2d.SegmentalTrack(mechanism="sprocket")
HOSTILE = "</script><img src=x onerror=\"document.title='broken'\">`${document.title='broken'}`"
RUNS: dict[str, tuple[c2d.Robot, Any]] = {
    "round wheels that stop": (ROBOT.with_track(ROUND), STEP),
    "gear wheels": (ROBOT.with_track(GEARED), STEP),
    "belt": (ROBOT, STEP),
    "belt with grousers": (ROBOT.with_track(c2d.GrouserBeltTrack()), STEP),
    "shoes": (ROBOT.with_track(c2d.SegmentalTrack()), c2d.terrains.step(0.05)),
    "shoes on two lanes": (ROBOT.with_track(c2d.SegmentalTrack(shoe_shape="trapezoid")), LANES),
    "sprockets on two lanes": (ROBOT.with_track(SPROCKET), LANES),
    "sprocket with flippers": (with_flippers(SPROCKET), c2d.terrains.step(0.2)),
    "skids": (ROBOT.with_track(c2d.ForceTrack()), c2d.terrains.step(0.1)),
    "two lanes": (ROBOT.with_track(GEARED), c2d.terrains.diagonal_barrier(0.5, height=0.03)),
    "circumferential": (ROBOT.with_track(RING), c2d.terrains.barrier(0.1, 0.02)),
    "flippers with grousers": (with_flippers(c2d.GrouserBeltTrack()), c2d.terrains.step(0.2)),
    "flippers with gear wheels": (with_flippers(GEARED, GEARED_ARMS), c2d.terrains.step(0.2)),
}

# From now on, with which transform [a, b, c, d, e, f] each path of its own is filled.
FILLS = """() => {
    window.fills = [];
    const fill = CanvasRenderingContext2D.prototype.fill;
    CanvasRenderingContext2D.prototype.fill = function (path, ...rule) {
        if (path instanceof Path2D) {
            const { a, b, c, d, e, f } = this.getTransform();
            window.fills.push([a, b, c, d, e, f]);
        }
        return path === undefined ? fill.call(this) : fill.call(this, path, ...rule);
    };
}"""


def simulated(name: str) -> c2d.Run:
    robot, terrain = RUNS[name]
    gait = None if robot.flippers is None else c2d.Climb()
    return c2d.simulate(robot, terrain, drive=c2d.Drive(gait=gait), duration=4.0)


@pytest.fixture(scope="module")
def stopped() -> c2d.Run:
    return simulated("round wheels that stop")


@pytest.mark.parametrize("name", RUNS)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_page_shows_robot_and_strip(open_page: Open, name: str, scheme: str) -> None:
    page = open_page(simulated(name).to_html(time=1.0), color_scheme=scheme)
    assert page.eval_on_selector("#scene", COLOURS) > 20
    assert page.eval_on_selector("#strip", COLOURS) > 10
    assert clock(page) == 1.0
    # Moving bodies are drawn moving.
    before = checksum(page)
    page.keyboard.press("ArrowRight")
    assert checksum(page) != before


def test_dark_is_dark_and_light_is_light(open_page: Open, stopped: c2d.Run) -> None:
    def brightness(scheme: str) -> list[float]:
        page = open_page(stopped.to_html(), color_scheme=scheme)
        page.evaluate(DRAWN)
        colors = page.evaluate(
            """() => [getComputedStyle(document.body).backgroundColor,
                getComputedStyle(document.body).color]"""
        )
        return [sum(float(part) for part in c[4:-1].split(",")) / 3 for c in colors]

    light, dark = brightness("light"), brightness("dark")
    assert light[0] - light[1] > 150
    assert dark[1] - dark[0] > 150


def test_a_change_of_the_scheme_redraws_the_picture(open_page: Open, stopped: c2d.Run) -> None:
    page = open_page(stopped.to_html(), color_scheme="light")
    before = checksum(page)
    page.emulate_media(color_scheme="dark")
    assert checksum(page) != before


def test_playing_goes_on_in_time_until_it_is_paused(open_page: Open, stopped: c2d.Run) -> None:
    page = open_page(stopped.to_html(time=0.5))
    page.click("#play")
    assert page.get_attribute("#play", "aria-label") == "pause"
    page.wait_for_timeout(400)
    page.click("#play")
    assert page.get_attribute("#play", "aria-label") == "play"
    paused = clock(page)
    assert 0.5 < paused < 3.9
    page.wait_for_timeout(100)
    assert clock(page) == paused


def test_playing_stops_at_the_end_and_starts_again_from_there(
    open_page: Open, stopped: c2d.Run
) -> None:
    page = open_page(stopped.to_html())
    assert clock(page) == stopped.time[-1]
    page.select_option("#speed", "2")  # slow enough to be seen playing on a busy machine
    page.click("#play")
    page.wait_for_selector("#play[aria-label=pause]")
    page.wait_for_selector("#play[aria-label=play]")
    assert clock(page) == stopped.time[-1]


def test_the_scrub_bar_and_the_strip_set_the_time(open_page: Open, stopped: c2d.Run) -> None:
    page = open_page(stopped.to_html())
    page.fill("#scrub", "150")
    assert clock(page) == pytest.approx(stopped.time[150], abs=5e-3)
    box = page.locator("#strip").bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 30)
    assert 1.5 < clock(page) < 2.5
    assert page.get_attribute("#scrub", "aria-valuetext") == f"{clock(page):.2f} seconds"


def test_wheel_drag_and_double_click_move_the_view(open_page: Open, stopped: c2d.Run) -> None:
    page = open_page(stopped.to_html())
    box = page.locator("#scene").bounding_box()
    assert box is not None
    x, y = box["x"] + 400, box["y"] + 200
    first = checksum(page)
    page.mouse.move(x, y)
    page.mouse.wheel(0, -300)
    page.wait_for_timeout(100)
    zoomed = checksum(page)
    assert zoomed != first
    page.mouse.down()
    page.mouse.move(x + 60, y + 30)
    page.mouse.up()
    assert checksum(page) != zoomed
    page.mouse.dblclick(x, y)
    assert checksum(page) == first


def test_the_view_follows_the_robot(open_page: Open, stopped: c2d.Run) -> None:
    page = open_page(stopped.to_html(time=0.0))
    still = checksum(page)
    page.check("#follow")
    followed = checksum(page)
    assert followed != still
    page.uncheck("#follow")
    page.click("#reset")
    assert checksum(page) == still


def test_keys_do_what_the_page_says(open_page: Open, stopped: c2d.Run) -> None:
    page = open_page(stopped.to_html())
    page.keyboard.press("Home")
    assert clock(page) == 0.0
    page.keyboard.press("ArrowRight")
    assert clock(page) == 0.01
    page.keyboard.press("Shift+ArrowRight")
    assert clock(page) == 0.11
    page.keyboard.press("ArrowLeft")
    assert clock(page) == 0.10
    page.keyboard.press("End")
    assert clock(page) == stopped.time[-1]
    first = checksum(page)
    page.keyboard.press("+")
    assert checksum(page) != first
    page.keyboard.press("0")
    assert checksum(page) == first
    page.keyboard.press("f")
    assert page.is_checked("#follow")
    page.keyboard.press("Home")
    page.keyboard.press("Space")
    page.wait_for_timeout(300)
    page.keyboard.press("Space")
    assert 0.0 < clock(page) < stopped.time[-1]


def test_keys_work_once_where_a_control_has_the_focus(open_page: Open, stopped: c2d.Run) -> None:
    page = open_page(stopped.to_html(time=1.0))
    page.focus("#scrub")
    page.keyboard.press("ArrowRight")
    assert clock(page) == 1.01
    page.focus("#play")
    page.keyboard.press("Space")
    assert page.get_attribute("#play", "aria-label") == "pause"
    page.keyboard.press("Space")
    assert page.get_attribute("#play", "aria-label") == "play"


def frames_of_fills(page: Page) -> list[Any]:
    """World frames of everything that the page fills one sample later, shape (2, 3)."""
    page.evaluate(FILLS)
    page.keyboard.press("ArrowRight")
    page.evaluate(DRAWN)
    fills = [np.array(fill).reshape(3, 2).T for fill in page.evaluate("window.fills")]
    world, *others = fills  # the ground is in the frame of the world
    frames = []
    for fill in others:
        frame = np.linalg.solve(world[:, :2], fill)
        frame[:, 2] -= np.linalg.solve(world[:, :2], world[:, 2])
        frames.append(frame)
    return frames


def has_frame(frames: list[Any], place: Any, angle: float) -> bool:
    """Whether one of the frames is at a position [m] and angle [rad], to 0.1 mm and 1 mrad."""
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    pose = np.column_stack([turn, place])
    nearest = min((np.abs(pose - frame) for frame in frames), key=lambda miss: float(miss.max()))
    return bool(nearest[:, 2].max() < 1e-4 and nearest[:, :2].max() < 1e-3)


@pytest.mark.parametrize("name", [name for name in RUNS if "shoe" in name or "sprocket" in name])
def test_a_chain_and_its_wheels_lie_where_the_run_has_them(open_page: Open, name: str) -> None:
    run = simulated(name)
    sample = 170  # the front is on the step
    frames = frames_of_fills(open_page(run.to_html(time=run.time[sample - 1])))
    for *place, angle in run.shoe_poses[sample, -22:]:  # the right one of two tracks is in front
        assert has_frame(frames, place, angle)
    scene = scene_of(run)
    for row in scene.carriers[0].bodies:
        # Those within the guide are drawn smaller.
        if scene.kinds[row].is_in_chain and scene.bodies["body"][row] >= 0:
            *place, angle = scene.poses[sample, row]
            assert has_frame(frames, place, angle)


@pytest.mark.parametrize("sample", [120, 200, 260])
def test_the_flippers_of_the_page_lie_where_the_run_has_them(open_page: Open, sample: int) -> None:
    run = simulated("flippers with grousers")
    frames = frames_of_fills(open_page(run.to_html(time=run.time[sample - 1])))
    scene = scene_of(run)
    _, *arms = scene.carriers
    for arm in arms:
        *place, angle = arm.poses[sample]
        assert has_frame(frames, place, angle)
        assert arm.circuit is not None
        for rib in arm.circuit.grousers:
            corners = scene.bodies["outline"][rib]
            seen = [corners @ frame[:, :2].T + frame[:, 2] for frame in frames]
            line = scene.outline(rib, sample)[:-1]
            assert min(np.abs(there - line).max() for there in seen) < 1e-4


@pytest.mark.parametrize("layer", ["forces", "speeds", "envelope"])
def test_every_layer_can_be_left_out(open_page: Open, stopped: c2d.Run, layer: str) -> None:
    page = open_page(stopped.to_html())
    first = checksum(page)
    page.uncheck(f"[data-layer={layer}]")
    assert checksum(page) != first
    page.check(f"[data-layer={layer}]")
    assert checksum(page) == first


def test_the_sentence_of_the_diagnosis_is_shown(open_page: Open) -> None:
    run = simulated("round wheels that stop")
    page = open_page(run.to_html())
    assert page.inner_text(".sentence") == str(run.diagnosis)
    assert page.inner_text(".mechanism").lower() == run.mechanism


def test_a_hostile_name_is_shown_and_does_nothing(open_page: Open, stopped: c2d.Run) -> None:
    scenario = stopped.scenario.replace({"robot.name": HOSTILE, "duration": 1.0})
    run = c2d.simulate(scenario)
    page = open_page(run.to_html())
    assert page.title() == " ".join(run.title.split())
    assert page.inner_text("h1").startswith("</script><img")
    assert page.locator("img").count() == 0
    assert page.eval_on_selector("#scene", COLOURS) > 20


def test_a_notebook_plays_the_run_in_its_frame(open_page: Open, stopped: c2d.Run) -> None:
    page = open_page(f"<!doctype html><title>book</title><p>before</p>{stopped._repr_html_()}")
    frame = page.frames[1]
    frame.wait_for_selector("#play")
    assert frame.eval_on_selector("#scene", COLOURS) > 20
    # The wheel is the notebook's until the picture is clicked.
    first = checksum(frame)
    box = page.locator("iframe").bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 300, box["y"] + 300)
    page.mouse.wheel(0, -100)
    page.wait_for_timeout(100)
    assert checksum(frame) == first
    frame.click("#scene")
    page.mouse.wheel(0, -100)
    page.wait_for_timeout(100)
    assert checksum(frame) != first
    frame.click("#play")
    page.wait_for_timeout(200)
    frame.click("#play")
    assert 0.0 < clock(frame) < stopped.time[-1]


def test_a_frame_cannot_reach_the_notebook(open_page: Open, stopped: c2d.Run) -> None:
    page = open_page(f"<!doctype html><title>book</title>{stopped._repr_html_()}")
    reach = "() => { try { return window.parent.document.title } catch (e) { return e.name } }"
    assert page.frames[1].evaluate(reach) == "SecurityError"


@pytest.mark.parametrize("width", [360, 700, 1600])
def test_the_page_fits_every_width(open_page: Open, stopped: c2d.Run, width: int) -> None:
    page = open_page(stopped.to_html())
    page.set_viewport_size({"width": width, "height": 800})
    page.evaluate(DRAWN)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    canvas = page.evaluate("[scene.clientWidth, scene.width / devicePixelRatio]")
    assert canvas[0] == pytest.approx(canvas[1], abs=1)


def test_every_control_has_a_name(open_page: Open, stopped: c2d.Run) -> None:
    page = open_page(stopped.to_html())
    unnamed = """() => [...document.querySelectorAll("button, input, select, canvas")].filter(e =>
        !(e.ariaLabel || e.innerText?.trim() || e.labels?.[0]?.innerText.trim())).length"""
    assert page.evaluate(unnamed) == 0


def test_runs_of_one_sample_and_without_contacts_open(open_page: Open) -> None:
    for duration in (0.0, 0.5):
        run = c2d.simulate(ROBOT, c2d.terrains.flat(), duration=duration, gravity=0.0)
        page = open_page(run.to_html())
        assert page.eval_on_selector("#scene", COLOURS) > 10
        assert page.eval_on_selector("#strip", COLOURS) > 2


def test_a_trial_shows_where_the_robot_ended_and_hides_it_again(open_page: Open) -> None:
    run = c2d.simulate(ROBOT.with_track(ROUND), STEP, trials="all")
    page = open_page(run.to_html())
    buttons = page.locator("[data-trial]")
    assert buttons.count() == 9
    before = page.locator("#scene").evaluate(CHECKSUM)
    seen = set()
    for number in range(buttons.count()):
        buttons.nth(number).click()
        page.wait_for_timeout(100)
        pressed = [buttons.nth(k).get_attribute("aria-pressed") for k in range(buttons.count())]
        assert pressed == [str(k == number).lower() for k in range(buttons.count())]
        seen.add(page.locator("#scene").evaluate(CHECKSUM))
    assert len(seen) >= 4
    buttons.last.click()
    page.locator("#reset").click()
    page.wait_for_timeout(100)
    assert page.locator("#scene").evaluate(CHECKSUM) == before


# From now on, what each picture has written.
TEXTS = """() => {
    window.texts = [];
    const write = CanvasRenderingContext2D.prototype.fillText;
    CanvasRenderingContext2D.prototype.fillText = function (text, ...place) {
        window.texts.push(text);
        return write.call(this, text, ...place);
    };
}"""


def test_the_deepest_edge_is_named_by_its_own_wheels(open_page: Open, stopped: c2d.Run) -> None:
    """Another edge that came inside later lies between other wheels."""
    before, events, rest = re.split(r'(?<="events":)(\[.*?\])(?=,"ground")', stopped.to_html())
    later = {"kind": "intrusion", "start": 0.0, "end": stopped.time[-1], "carrier": 0}
    found = json.loads(events)
    for lane, edge in ((0, 0), (1, 1)):
        found.append({**later, "lane": lane, "edge": edge, "bodies": [3, 2]})
    page = open_page(before + json.dumps(found) + rest)
    page.evaluate(TEXTS)
    page.keyboard.press("End")
    page.evaluate(DRAWN)
    named = [text for text in page.evaluate("window.texts") if text.startswith("between wheels")]
    assert named == ["between wheels 1 and 2"]


@pytest.mark.parametrize("start", [0.0, 1.0])
def test_the_times_of_a_run_and_of_a_branch_have_their_unit(
    open_page: Open, stopped: c2d.Run, start: float
) -> None:
    run = stopped.branch(start, duration=2.0) if start else stopped
    page = open_page(run.to_html())
    page.evaluate(TEXTS)
    page.keyboard.press("End")
    page.evaluate(DRAWN)
    times = [text for text in page.evaluate("window.texts") if re.fullmatch(r"[\d.]+ s", text)]
    assert len(times) == 1
    assert float(times[0].removesuffix(" s")) >= start
