"""The page of an audit in a real browser: it fits, and begins with a replay that plays."""

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page

import crawler2d as c2d
from tests.audits.seizing import QUIET, SEIZING, STEP, seizing_file
from tests.browser.seen import COLOURS, DRAWN, Open, checksum, clock

HOSTILE = "</script><img src=x onerror=\"document.title='broken'\">`${document.title='broken'}`"
NAME = HOSTILE.replace("<", "&lt;").replace('"', "&quot;")


@pytest.fixture(scope="module")
def repaired() -> str:
    found = c2d.audit(SEIZING, STEP, unknown={}, repeats=10, **QUIET)
    return found.to_html()


@pytest.fixture(scope="module")
def hostile(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The page of a file in which all names are hostile."""
    path = tmp_path_factory.mktemp("cart") / "cart <i>.urdf"
    path.write_text(seizing_file(NAME, NAME), encoding="utf-8")
    steps = {f"{HOSTILE}{each}": c2d.terrains.step(each) for each in (0.06, 0.075)}
    return c2d.audit(path, steps, samples=4, repeats=1, repair=False, **QUIET).to_html()


def wide(place: str) -> str:
    """Return a script that finds elements of a page that overflow sideways and do not scroll."""
    return f"""() => [...document.querySelectorAll("{place}")].filter(each =>
        each.scrollWidth > each.clientWidth + 1
        && getComputedStyle(each).overflowX === "visible").map(each => each.outerHTML)"""


def playing(page: Page) -> bool:
    return bool(page.get_attribute("#play", "aria-label") == "pause")


@pytest.mark.parametrize("width", [360, 390, 768, 1000, 1280, 1900])
def test_the_page_fits_every_width(
    open_page: Open, hostile: str, repaired: str, width: int
) -> None:
    for html in (hostile, repaired):
        page = open_page(html)
        page.set_viewport_size({"width": width, "height": 800})
        page.eval_on_selector_all("details", "all => all.forEach(each => each.open = true)")
        page.evaluate(DRAWN)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        # Nothing overflows except wide tables and texts, which scroll, and an option that is too
        # long, of which a select shows what fits.
        assert page.evaluate(wide("main *:not(svg *, select, option)")) == []
        boxes = page.eval_on_selector_all(
            "svg, select, canvas:not([hidden] *), .scroll, pre",
            "all => all.map(e => e.getBoundingClientRect()).map(box => [box.left, box.right])",
        )
        assert all(0 <= left < right <= width for left, right in boxes)


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (390, 844)])
def test_the_replay_is_in_the_first_screen(
    open_page: Open, repaired: str, width: int, height: int
) -> None:
    page = open_page(repaired, reduced_motion="reduce")
    page.set_viewport_size({"width": width, "height": height})
    page.evaluate(DRAWN)
    boxes = [each.bounding_box() for each in page.locator("canvas").all()]
    first, second = (box for box in boxes if box is not None)
    assert first["y"] + first["height"] < height
    if width == 1280:
        assert second["y"] == pytest.approx(first["y"], abs=0.5)
        assert page.locator(".diagnosis").is_visible()
    else:
        assert second["y"] < height
    for canvas in page.locator("canvas").all():
        assert canvas.evaluate(COLOURS) > 20


def test_the_replay_plays_by_itself_and_both_runs_have_one_clock(
    open_page: Open, repaired: str
) -> None:
    page = open_page(repaired)
    assert playing(page)
    start = clock(page)
    page.wait_for_timeout(400)
    page.click("#play")
    assert clock(page) > start
    assert not playing(page)
    drawn = [checksum(page, f".pair figure:nth-child({k}) canvas") for k in (1, 2)]
    page.fill("#scrub", "0")
    assert clock(page) == 0.0
    again = [checksum(page, f".pair figure:nth-child({k}) canvas") for k in (1, 2)]
    assert all(before != after for before, after in zip(drawn, again, strict=True))


def test_a_run_that_is_over_stays_as_it_ended(open_page: Open, repaired: str) -> None:
    page = open_page(repaired, reduced_motion="reduce")
    repaired_one = ".pair figure:nth-child(2) canvas"
    end, ended = clock(page), checksum(page, repaired_one)
    page.fill("#scrub", str(end - 1.0))  # the robot that is repaired has cleared before
    assert clock(page) < end
    assert checksum(page, repaired_one) == ended


def test_with_reduced_motion_nothing_moves(open_page: Open, repaired: str) -> None:
    page = open_page(repaired, reduced_motion="reduce")
    assert not playing(page)
    now, end = page.inner_text("#clock").removesuffix(" s").split(" / ")
    assert now == end
    drawn = checksum(page, "canvas")
    page.wait_for_timeout(200)
    assert checksum(page, "canvas") == drawn


def test_another_obstacle_is_shown_by_the_list_and_by_the_table(
    open_page: Open, hostile: str
) -> None:
    page = open_page(hostile, reduced_motion="reduce")
    assert page.locator("#obstacle option").count() == 2
    shows: list[tuple[int, Callable[[], object]]] = [
        (1, lambda: page.select_option("#obstacle", "1")),
        (0, lambda: page.click("a[href='#replay-0']")),
        (1, lambda: page.evaluate("location.hash = '#replay-1'")),
    ]
    for number, show in shows:
        show()
        page.wait_for_selector(f"#replay-{number}:not([hidden])")
        assert page.locator(".runs:visible").count() == 1
        assert page.input_value("#obstacle") == str(number)
        for canvas in page.locator(f"#replay-{number} canvas").all():
            page.evaluate(DRAWN)
            assert canvas.evaluate(COLOURS) > 20
    top = page.locator("#stage").bounding_box()
    assert top is not None
    assert abs(top["y"]) < 5


def test_the_keyboard_is_enough(open_page: Open, hostile: str) -> None:
    page = open_page(hostile, reduced_motion="reduce")
    page.focus("a[href='#replay-1']")
    page.keyboard.press("Enter")
    page.wait_for_selector("#replay-1:not([hidden])")
    page.wait_for_selector("#play:focus")
    page.keyboard.press("Space")
    assert playing(page)
    page.keyboard.press("Space")
    page.keyboard.press("Tab")
    page.keyboard.press("Home")
    assert clock(page) == 0.0
    canvas = "#replay-1 canvas"
    page.focus(canvas)
    drawn = checksum(page, canvas)
    page.keyboard.press("+")
    assert checksum(page, canvas) != drawn
    page.keyboard.press("0")
    assert checksum(page, canvas) == drawn


def test_the_wheel_scrolls_the_page_until_a_picture_is_clicked(
    open_page: Open, repaired: str
) -> None:
    page = open_page(repaired, reduced_motion="reduce")
    drawn = checksum(page, "canvas")
    page.hover("canvas")
    page.mouse.wheel(0, 50)
    page.wait_for_timeout(200)
    assert page.evaluate("scrollY") > 0
    assert checksum(page, "canvas") == drawn
    page.click("canvas")
    page.mouse.wheel(0, -50)
    page.wait_for_timeout(200)
    assert checksum(page, "canvas") != drawn
    assert page.evaluate("scrollY") > 0


def test_headings_are_in_order(open_page: Open, repaired: str) -> None:
    page = open_page(repaired)
    levels = page.eval_on_selector_all("h1, h2, h3", "all => all.map(each => each.localName)")
    assert len(levels) > 5
    assert levels == ["h1", *["h2"] * (len(levels) - 1)]


def test_hostile_names_are_shown_and_do_nothing(open_page: Open, hostile: str) -> None:
    page = open_page(hostile)
    assert page.inner_text("h1").startswith("</script><img")
    assert "broken'}`" in page.title()
    assert page.locator("img").count() == 0
    assert page.eval_on_selector("canvas", COLOURS) > 20


def test_without_scripts_everything_but_the_replay_is_there(
    browser: Browser, repaired: str
) -> None:
    page = browser.new_page(java_script_enabled=False)
    page.set_content(repaired)
    assert page.locator("noscript").inner_text().startswith("Only the replay needs JavaScript")
    assert not page.locator("canvas, #play").first.is_visible()
    assert page.locator(".diagnosis").is_visible()
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
    unnamed = """() => [...document.querySelectorAll(
        "a, summary, button, select, input, [tabindex], [role=img], section")].filter(e =>
        !(e.ariaLabel || e.textContent?.trim())).length"""
    assert page.evaluate(unnamed) == 0


def test_drawings_are_not_stretched(open_page: Open, repaired: str, tmp_path: Path) -> None:
    page = open_page(repaired)
    for width in (360, 1240):
        page.set_viewport_size({"width": width, "height": 800})
        page.eval_on_selector_all("details", "all => all.forEach(each => each.open = true)")
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
