"""The page of `crawler2d demo` in a real browser: it fits, and plays both runs."""

import pytest

from crawler2d.commands.demo import demo_page, demo_runs
from tests.browser.seen import CHECKSUM, COLOURS, DRAWN, Open, clock


@pytest.fixture(scope="module")
def demo() -> str:
    return demo_page(demo_runs())


@pytest.mark.parametrize("width", [360, 390, 768, 1280, 1900])
def test_the_page_fits_every_width_with_both_pictures(
    open_page: Open, demo: str, width: int
) -> None:
    page = open_page(demo)
    page.set_viewport_size({"width": width, "height": 800})
    page.evaluate(DRAWN)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    colours = page.eval_on_selector_all("canvas", f"all => all.map({COLOURS})")
    assert len(colours) == 2
    assert min(colours) > 20


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_both_runs_play_to_their_ends_on_one_clock(open_page: Open, demo: str, scheme: str) -> None:
    page = open_page(demo, color_scheme=scheme)
    assert page.get_attribute("#play", "aria-label") == "pause"
    page.click("#play")
    pictures = []
    for time in ("0", "1", "99"):
        page.eval_on_selector(
            "#scrub", f"it => {{ it.value = {time}; it.dispatchEvent(new Event('input')); }}"
        )
        page.evaluate(DRAWN)
        pictures.append(page.eval_on_selector_all("canvas", f"all => all.map({CHECKSUM})"))
    assert clock(page) == pytest.approx(demo_runs()[0].metrics["time"], abs=0.06)
    assert len({sums[0] for sums in pictures}) == len({sums[1] for sums in pictures}) == 3


def test_with_reduced_motion_the_page_shows_the_end(open_page: Open, demo: str) -> None:
    page = open_page(demo, reduced_motion="reduce")
    assert page.get_attribute("#play", "aria-label") == "play"
    assert clock(page) > 5.0
