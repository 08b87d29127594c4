"""The explorer in a browser, with a way to ask its core."""

import json
from typing import Any

import pytest
from playwright.sync_api import Browser, Page

from explorer.page import explorer_page
from explorer.wasm import compile_core
from tests.browser.conftest import browser, open_page
from tests.browser.seen import Open

__all__ = ["browser", "open_page"]

# A name for the parts of the page's scripts that tests use.
_EXPOSED = """
window.explored = { get views() { return views; }, Sentence, tables, requested };
"""

_ASK = """async ([scenario, trials, interval]) => {
    const { views: [{ core }], requested, Sentence, tables } = window.explored;
    const answer = await core.ask(requested(scenario, trials, interval));
    const { diagnosis } = answer;
    const sentence = diagnosis ? new Sentence(diagnosis, tables.words).text() : "";
    return JSON.stringify({ ...answer, sentence }, (_, value) =>
        ArrayBuffer.isView(value) ? [...value] : value);
}"""


def ask(page: Page, scenario: str, trials: Any = None, interval: float | None = None) -> Any:
    """Ask the core in the page for the answer to a scenario in JSON, with its sentence."""
    return json.loads(page.evaluate(_ASK, [scenario, trials, interval]))


def settled(page: Page) -> None:
    """Wait until both robots are simulated, and their stops judged."""
    page.wait_for_selector("html[data-ready]")
    page.wait_for_function(
        """() => window.explored.views.every(({ answer }) => answer?.judged || answer?.error)
            && window.explored.views.every(({ core }) => !core.busy && !core.waiting)"""
    )


@pytest.fixture(scope="session")
def html() -> str:
    return explorer_page(compile_core(), _EXPOSED)


@pytest.fixture
def page(open_page: Open, html: str) -> Page:
    page: Page = open_page(html)
    settled(page)
    return page


@pytest.fixture(scope="module")
def asked(browser: Browser, html: str, tmp_path_factory: pytest.TempPathFactory) -> Page:
    """One page for many requests."""
    path = tmp_path_factory.mktemp("explorer") / "explorer.html"
    path.write_text(html, encoding="utf-8")
    page = browser.new_page()
    page.goto(path.as_uri())
    settled(page)
    return page
