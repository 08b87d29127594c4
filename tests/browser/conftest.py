"""A real browser for pages.

`make test-browser` names it in CRAWLER2D_BROWSER, a path or "playwright" for its own.
"""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

from tests.browser.seen import DRAWN, Open


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    name = os.environ.get("CRAWLER2D_BROWSER", "playwright")
    path = None if name == "playwright" else name
    with sync_playwright() as playwright:
        # The pages are our own, and a container's root has no sandbox.
        browser = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture
def open_page(browser: Browser, tmp_path: Path) -> Iterator[Open]:
    """Open a page from a file; it must make no request and report no error."""
    seen: list[str] = []
    pages: list[Page] = []

    def opened(html: str, **options: Any) -> Page:
        path = tmp_path / f"page{len(pages)}.html"
        path.write_text(html, encoding="utf-8")
        page = browser.new_page(viewport={"width": 1000, "height": 800}, **options)
        pages.append(page)
        page.on("console", lambda message: seen.append(message.text))
        page.on("pageerror", lambda error: seen.append(str(error)))
        page.on("request", lambda request: seen.append(request.url))
        page.goto(path.as_uri())
        page.evaluate(DRAWN)
        seen.remove(path.as_uri())
        return page

    yield opened
    own = ("about:srcdoc", "data:,", "blob:")  # a worker's source is a blob of the page
    assert [text for text in seen if not text.startswith(own)] == []
    for page in pages:
        page.close()
