"""Visible state of a page: pixels of its canvases, and the displayed time of a replay."""

from collections.abc import Callable

from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Frame, Page

# The pixels of a copy: reading a canvas itself changes how it is drawn from then on.
PIXELS = """canvas => {
    const copy = new OffscreenCanvas(canvas.width, canvas.height);
    const context = copy.getContext("2d", { willReadFrequently: true });
    context.drawImage(canvas, 0, 0);
    return new Uint32Array(context.getImageData(0, 0, copy.width, copy.height).data.buffer);
}"""
COLOURS = f"canvas => new Set(({PIXELS})(canvas)).size"
# Changes with any pixel.
CHECKSUM = f"canvas => ({PIXELS})(canvas).reduce((sum, p) => (Math.imul(sum, 31) + p) | 0, 0)"
# Two frames later everything asked for is drawn.
DRAWN = "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"

RULES = {"runOnly": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]}

Open = Callable[..., Page]


def checksum(page: Page | Frame, canvas: str = "#scene") -> int:
    page.evaluate(DRAWN)
    return int(page.eval_on_selector(canvas, CHECKSUM))


def clock(page: Page | Frame) -> float:
    page.evaluate(DRAWN)
    return float(page.inner_text("#clock").split(" / ")[0])


def violations(page: Page) -> list[str]:
    """Run axe on a page with everything in it open."""
    page.eval_on_selector_all("details", "all => all.forEach(each => each.open = true)")
    page.evaluate(DRAWN)
    found = Axe().run(page, options=RULES).response["violations"]
    return [
        f"{rule['id']}: {node['html'][:120]}: {node.get('failureSummary', '')}"
        for rule in found
        for node in rule["nodes"]
    ]
