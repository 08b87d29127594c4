"""The page of an audit in a real browser: it fits, and its replays open, play and close."""

from pathlib import Path

import pytest
from playwright.sync_api import Browser, Frame, Page

import crawler2d as c2d
from tests.audits.seizing import QUIET, SEIZING, STEP, seizing_file
from tests.browser.seen import COLOURS, DRAWN, Open, clock

HOSTILE = "</script><img src=x onerror=\"document.title='broken'\">`${document.title='broken'}`"
NAME = HOSTILE.replace("<", "&lt;").replace('"', "&quot;")


@pytest.fixture(scope="module")
def repaired() -> str:
    found = c2d.audit(SEIZING, STEP, unknown={}, repeats=10, **QUIET)
    return found.to_html()


@pytest.fixture(scope="module")
def hostile(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The page of a file in which everything that has a name has a hostile one."""
    path = tmp_path_factory.mktemp("cart") / "cart <i>.urdf"
    path.write_text(seizing_file(NAME, NAME), encoding="utf-8")
    steps = {f"{HOSTILE}{label}": each for label, each in STEP.items()}
    return c2d.audit(path, steps, samples=4, repeats=1, repair=False, **QUIET).to_html()


def replay(page: Page, number: int) -> Frame:
    """Wait for a replay, in view: frames that are not draw nothing."""
    place = page.locator("iframe").nth(number)
    place.wait_for()
    place.scroll_into_view_if_needed()
    frame = page.frames[1 + number]
    frame.wait_for_selector("#play")
    return frame


@pytest.mark.parametrize("width", [360, 768, 1000, 1240, 1900])
def test_the_page_fits_every_width(
    open_page: Open, hostile: str, repaired: str, width: int
) -> None:
    for html in (hostile, repaired):
        page = open_page(html)
        page.set_viewport_size({"width": width, "height": 800})
        page.click("a[href='#replay-0']")
        replay(page, 1)
        page.eval_on_selector_all("details", "all => all.forEach(each => each.open = true)")
        page.evaluate(DRAWN)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        # Nothing of a table stands out of it.
        wide = """all => all.filter(each => each.scrollWidth > each.clientWidth + 1).length"""
        assert page.eval_on_selector_all("table, td, tbody th", wide) == 0


def test_a_click_opens_the_replay_of_model_and_belt(open_page: Open, repaired: str) -> None:
    page = open_page(repaired)
    assert len(page.frames) == 1
    page.click("a[href='#replay-0']")
    page.locator("iframe").nth(1).wait_for()
    assert page.evaluate("document.activeElement.localName") == "summary"
    box = page.locator(".replay summary").bounding_box()
    assert box is not None
    assert 0 <= box["y"] < 400
    for number, ending in ((0, "seized"), (1, "cleared")):
        frame = replay(page, number)
        assert ending in frame.inner_text(".outcome")
        assert frame.eval_on_selector("#scene", COLOURS) > 20
    belt = replay(page, 1)
    start = clock(belt)
    belt.click("#play")
    page.wait_for_timeout(400)
    belt.click("#play")
    assert clock(belt) > start


def test_a_replay_that_is_closed_is_gone_and_opens_again(open_page: Open, repaired: str) -> None:
    page = open_page(repaired)
    for _ in range(2):
        page.click(".replay summary")
        replay(page, 1)
        page.click(".replay summary")
        page.wait_for_selector("iframe", state="detached")


def test_the_keyboard_is_enough(open_page: Open, repaired: str) -> None:
    page = open_page(repaired)
    page.focus("a[href='#replay-0']")
    page.keyboard.press("Enter")
    replay(page, 1)
    page.keyboard.press("Space")  # the focus is on the head of the box
    page.wait_for_selector("iframe", state="detached")
    page.keyboard.press("Enter")
    frame = replay(page, 0)
    page.keyboard.press("Tab")
    frame.wait_for_selector(":focus")  # a frame has a process of its own
    page.keyboard.press("Home")
    frame.wait_for_selector("#clock:text('0.00 /')")


def test_an_address_with_a_replay_opens_it(open_page: Open, repaired: str) -> None:
    page = open_page(repaired)
    page.evaluate("location.hash = '#replay-0'")
    replay(page, 1)


def test_a_replay_cannot_reach_the_page(open_page: Open, repaired: str) -> None:
    page = open_page(repaired)
    page.click("a[href='#replay-0']")
    reach = "() => { try { return window.parent.document.title } catch (e) { return e.name } }"
    assert replay(page, 0).evaluate(reach) == "SecurityError"


def test_hostile_names_are_shown_and_do_nothing(open_page: Open, hostile: str) -> None:
    page = open_page(hostile)
    page.click("a[href='#replay-0']")
    model = replay(page, 0)
    assert page.inner_text("h1").startswith("</script><img")
    assert "broken'}`" in page.title()
    for frame in (page, model):
        assert frame.locator("img").count() == 0
    assert model.eval_on_selector("#scene", COLOURS) > 20


def test_without_scripts_everything_but_the_replays_is_there(
    browser: Browser, repaired: str
) -> None:
    page = browser.new_page(java_script_enabled=False)
    page.set_content(repaired)
    assert page.locator("noscript").inner_text().startswith("The replays need JavaScript")
    assert page.locator("tbody tr").count() > 10
    page.close()


def test_dark_is_dark_and_light_is_light(open_page: Open, repaired: str) -> None:
    colours = """() => ["backgroundColor", "color"].map(name => {
        const parts = getComputedStyle(document.body)[name].match(/\\d+/g);
        return parts.reduce((sum, part) => sum + +part, 0);
    })"""
    for scheme, sign in (("light", 1), ("dark", -1)):
        page, ink = open_page(repaired, color_scheme=scheme).evaluate(colours)
        assert sign * (page - ink) > 450


def test_every_control_and_picture_has_a_name(open_page: Open, repaired: str) -> None:
    page = open_page(repaired)
    unnamed = """() => [...document.querySelectorAll("a, summary, table, svg, iframe")].filter(e =>
        !(e.ariaLabel || e.title || e.textContent?.trim())).length"""
    assert page.evaluate(unnamed) == 0


def test_drawings_are_not_stretched(open_page: Open, repaired: str, tmp_path: Path) -> None:
    page = open_page(repaired)
    for width in (360, 1240):
        page.set_viewport_size({"width": width, "height": 800})
        page.screenshot(path=tmp_path / f"{width}.png", full_page=True)
        sizes = page.eval_on_selector_all(
            "svg",
            """all => all.map(each => {
                const style = getComputedStyle(each), box = each.getBoundingClientRect();
                const pads = (a, b) => parseFloat(style[a]) + parseFloat(style[b]);
                const across = pads("paddingLeft", "paddingRight")
                    + pads("borderLeftWidth", "borderRightWidth");
                const along = pads("paddingTop", "paddingBottom")
                    + pads("borderTopWidth", "borderBottomWidth");
                const view = each.viewBox.baseVal;
                return (box.width - across) / view.width / ((box.height - along) / view.height);
            })""",
        )
        assert len(sizes) > 3
        assert sizes == pytest.approx([1.0] * len(sizes), rel=0.02)
