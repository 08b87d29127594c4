"""The widget of a replay in a real browser, with a model like that of a notebook."""

import json
from typing import Any

import pytest
from playwright.sync_api import Frame, Page

import crawler2d as c2d
from crawler2d.pictures.page import read_part
from tests.browser.seen import DRAWN, Open, clock
from tests.shared import ROBOT

# What a notebook gives a widget: values by name, and who is told when one changes.
HOST = """<!doctype html><html><body><div id="cell"></div><script type="module">
const listeners = {};
window.saved = [];
window.model = {
  values: VALUES,
  get(name) { return this.values[name]; },
  set(name, value) {
    this.values[name] = value;
    for (const listener of listeners[`change:${name}`] ?? []) listener();
  },
  save_changes() { window.saved.push(this.values.time); },
  on(name, listener) { (listeners[name] ??= []).push(listener); },
};
SCRIPT
window.remove = render({ model: window.model, el: document.getElementById("cell") });
</script></body></html>"""

SLOWEST = 20_000  # [ms]


def page_of(duration: float) -> str:
    """A page that opens at the end of its run, 0.5 s before or after that of another."""
    return c2d.simulate(ROBOT, c2d.terrains.flat(), duration=duration).to_html(time=duration)


def hosted(open_page: Open, page: str) -> Page:
    values: dict[str, Any] = {"page": page, "time": 0.0, "height": 700}
    text = json.dumps(values).replace("</", "<\\/")
    script = read_part("widget.js").replace("export default { render };", "")
    host = open_page(HOST.replace("VALUES", text).replace("SCRIPT", script))
    host.wait_for_function("window.saved.length > 0", timeout=SLOWEST)
    return host


def framed(host: Page) -> Frame:
    host.wait_for_function(
        "() => document.querySelectorAll('iframe').length === 1", timeout=SLOWEST
    )
    frame = host.locator("iframe").element_handle(timeout=SLOWEST).content_frame()
    assert frame is not None
    return frame


@pytest.fixture(scope="module")
def pages() -> tuple[str, str]:
    return page_of(1.0), page_of(1.5)


def test_it_shows_the_page_and_tells_its_time(open_page: Open, pages: tuple[str, str]) -> None:
    host = hosted(open_page, pages[0])
    assert host.eval_on_selector("iframe", "frame => frame.clientHeight") == 700
    assert clock(framed(host)) == 1.0
    assert host.evaluate("window.saved") == [pytest.approx(1.0, abs=1e-3)]
    framed(host).press("#scene", "Home")
    host.wait_for_function("window.saved.at(-1) === 0", timeout=SLOWEST)


def test_setting_the_time_moves_the_replay(open_page: Open, pages: tuple[str, str]) -> None:
    host = hosted(open_page, pages[0])
    host.evaluate("window.model.set('time', 0.25)")
    host.wait_for_function("Math.abs(window.saved.at(-1) - 0.25) < 1e-3", timeout=SLOWEST)
    assert clock(framed(host)) == 0.25


def test_playing_reports_its_time_without_stopping(open_page: Open, pages: tuple[str, str]) -> None:
    host = hosted(open_page, pages[1])
    framed(host).press("#scene", "Home")
    framed(host).click("#play")
    host.wait_for_function("window.saved.at(-1) > 1.49", timeout=SLOWEST)
    assert host.evaluate("window.saved.length") > 5


def test_another_page_takes_its_place(open_page: Open, pages: tuple[str, str]) -> None:
    host = hosted(open_page, pages[0])
    host.evaluate("page => window.model.set('page', page)", pages[1])
    host.wait_for_function("Math.abs(window.saved.at(-1) - 1.5) < 1e-3", timeout=SLOWEST)
    assert clock(framed(host)) == 1.5


def test_of_pages_that_come_faster_than_they_load_the_last_one_stays(
    open_page: Open, pages: tuple[str, str]
) -> None:
    host = hosted(open_page, pages[0])
    host.evaluate(
        """pages => {
            for (let k = 0; k < 20; k++) window.model.set("page", pages[k % 2]);
            window.most = document.querySelectorAll("iframe").length;
        }""",
        [pages[0], pages[1]],
    )
    assert host.evaluate("window.most") <= 2
    host.wait_for_function("Math.abs(window.saved.at(-1) - 1.5) < 1e-3", timeout=SLOWEST)
    assert clock(framed(host)) == 1.5


def test_messages_of_others_are_ignored_and_none_is_heard_after_its_end(
    open_page: Open, pages: tuple[str, str]
) -> None:
    host = hosted(open_page, pages[0])
    host.evaluate("window.postMessage({ crawler2d: 0.5 }, '*')")
    host.evaluate(DRAWN)
    assert host.evaluate("window.saved.length") == 1
    host.evaluate("window.remove()")
    framed(host).press("#scene", "Home")
    framed(host).evaluate(DRAWN)
    host.evaluate(DRAWN)
    assert host.evaluate("window.saved.length") == 1
