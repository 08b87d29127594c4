"""Pages obey the rules of WCAG 2.2 AA that axe checks, and the keyboard reaches every control."""

import pytest
from playwright.sync_api import Page

import crawler2d as c2d
from crawler2d.commands.demo import demo_page, demo_runs
from tests.audits.seizing import QUIET, SEIZING, STEP
from tests.browser.seen import Open, violations

STEPS = 200
"""Times that Tab is pressed, at most."""


@pytest.fixture(scope="module")
def pages() -> dict[str, str]:
    runs = demo_runs()
    found = c2d.audit(SEIZING, STEP, unknown={}, repeats=10, **QUIET)
    return {"replay": runs[0].to_html(), "demo": demo_page(runs), "audit": found.to_html()}


def reached(page: Page) -> list[str]:
    """Press Tab until the focus has gone round; return the focused elements in order."""
    found: list[str] = []
    for _ in range(STEPS):
        page.keyboard.press("Tab")
        here = page.evaluate(
            """() => document.activeElement === document.body ? ""
            : (document.activeElement.id || document.activeElement.outerHTML.slice(0, 100))"""
        )
        if not here:
            return found
        found.append(here)
    raise AssertionError(f"the focus has not gone round after {STEPS} steps")


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("name", ["replay", "demo", "audit"])
def test_axe_finds_nothing(open_page: Open, pages: dict[str, str], name: str, scheme: str) -> None:
    page = open_page(pages[name], color_scheme=scheme)
    assert violations(page) == []


@pytest.mark.parametrize("name", ["replay", "demo", "audit"])
def test_the_keyboard_reaches_every_control(
    open_page: Open, pages: dict[str, str], name: str
) -> None:
    page = open_page(pages[name])
    controls = page.eval_on_selector_all(
        "button, input, select, a[href], summary",
        """all => all.filter(each => each.checkVisibility() && !each.disabled)
        .map(each => each.id || each.outerHTML.slice(0, 100))""",
    )
    assert controls
    assert set(controls) <= set(reached(page))
