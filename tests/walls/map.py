"""Draws docs/rooms.svg: the rooms of core and package, and imports between them."""

from collections import Counter
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch
from matplotlib.path import Path as Line

from tests.walls.houses import files_of, imports_of
from tests.walls.rooms import ROOT, House

# After Okabe and Ito's palette, and dark enough for white words: readable on white and on black.
COLORS = ("#0072B2", "#C65200", "#00845F", "#B0568C", "#2F86BE", "#9A7206")
# Text outside of the boxes must be readable on white and on black, too.
BESIDE = "#808080"

# They make names from all rooms public, so arrows would have no meaning.
DOORS = ("lib.rs", "__init__.py")

# Size of a room in inches, the unit of the drawing.
WIDTH, HEIGHT, GAP = 2.3, 0.46, 0.26
STEP = HEIGHT + GAP
# Distance between the middles of the columns, and width of the widest arc.
APART, REACH = 4.6, 1.5


def column(ax: Axes, house: House, middle: float, outwards: int, title: str) -> None:
    """Draw the rooms of a house above each other, and arcs of imports on their outer side."""
    counts: Counter[tuple[int, int]] = Counter()
    for each in imports_of(house):
        here, there = house.floor(each.file), house.floor(each.imported)
        if here is None or there is None or house.rooms[here] in DOORS:
            continue
        if there < here:  # otherwise the tests of walls fail
            counts[here, there] += 1
    farthest = max((upper - lower for upper, lower in counts), default=1)
    # Long ones first, so that short ones are above them.
    for (upper, lower), count in sorted(counts.items(), key=lambda item: item[0][1] - item[0][0]):
        if upper - lower == 1:
            line = step(middle - outwards * WIDTH / 4, upper, lower)
        else:
            reach = outwards * REACH * (upper - lower) / farthest
            line = arc(middle + outwards * WIDTH / 2, reach, (upper, lower), list(counts))
        arrow(ax, line, COLORS[upper % len(COLORS)], min(0.9 + 0.07 * count, 2.6))
    files = Counter(house.floor(file) for file in files_of(house))
    for floor, room in enumerate(house.rooms):
        box(ax, middle, floor, room, files[floor])
    top = len(house.rooms) * STEP + 0.02
    ax.text(middle, top, title, ha="center", color=BESIDE, fontsize=13, fontweight="bold")


def box(ax: Axes, middle: float, floor: int, room: str, files: int) -> None:
    """Draw one room: a folder with the number of its files, or a single file."""
    is_folder = room.endswith("/")
    left, bottom = middle - WIDTH / 2, floor * STEP
    color = COLORS[floor % len(COLORS)]
    style = f"round,pad=0,rounding_size={0.11 if is_folder else 0.02}"
    ax.add_patch(
        FancyBboxPatch((left, bottom), WIDTH, HEIGHT, style, facecolor=color, linewidth=0, zorder=3)
    )
    y = bottom + HEIGHT / 2
    ax.text(
        left + 0.16,
        y,
        room.rstrip("/"),
        va="center_baseline",
        color="white",
        fontsize=12,
        zorder=4,
        fontweight="bold" if is_folder else "normal",
    )
    if is_folder:
        ax.text(
            left + WIDTH - 0.16,
            y,
            f"{files} file{'s' * (files != 1)}",
            ha="right",
            va="center_baseline",
            color="white",
            fontsize=9.5,
            zorder=4,
        )


def step(x: float, upper: int, lower: int) -> Line:
    """Draw an arrow from a room to the one below it."""
    return Line([(x, upper * STEP), (x, lower * STEP + HEIGHT)])


def arc(side: float, reach: float, ends: tuple[int, int], every: list[tuple[int, int]]) -> Line:
    """Draw an arc from a room to another, round those between, with separate ends."""
    upper, lower = ends
    # The lower half of a side is for outgoing arcs, the upper for incoming ones; long ones outside.
    leaving = sorted(b for a, b in every if a == upper and a - b > 1)
    coming = sorted(a for a, b in every if b == lower and a - b > 1)
    out = (len(leaving) - leaving.index(lower)) / (len(leaving) + 1)
    into = (len(coming) - coming.index(upper)) / (len(coming) + 1)
    start, end = upper * STEP + 0.5 * HEIGHT * out, lower * STEP + 0.5 * HEIGHT * (1.0 + into)
    far = side + 4.0 / 3.0 * reach  # a curve reaches three quarters of its handles
    return curve([(side, start), (far, start), (far, end), (side, end)])


def curve(points: list[tuple[float, float]]) -> Line:
    """Draw a curve from the first of four points to the last, with the others as handles."""
    return Line(points, [Line.MOVETO, Line.CURVE4, Line.CURVE4, Line.CURVE4])


def arrow(ax: Axes, line: Line, color: str, width: float, style: Any = "-") -> None:
    """Draw a line that ends in a head."""
    head = "-|>,head_length=4.5,head_width=2.2"
    patch = FancyArrowPatch(path=line, arrowstyle=head, color=color, shrinkA=0, shrinkB=1)
    patch.set(linewidth=width, linestyle=style, joinstyle="miter", zorder=2)
    ax.add_patch(patch)


def bridge(ax: Axes, core: House, package: House) -> None:
    """Draw the connection of package and core, through the binding."""
    top = core.rooms.index("lib.rs") * STEP + HEIGHT / 2
    bottom = package.rooms.index("_core.pyi") * STEP + HEIGHT / 2
    left, right = WIDTH / 2, APART - WIDTH / 2
    between = (left + right) / 2
    line = curve([(right, bottom), (between, bottom), (between, top), (left, top)])
    arrow(ax, line, BESIDE, 1.4, (0, (4, 3)))
    text = "python/src:\nJSON in,\ncolumns out"
    words = ax.text(between + 0.12, (top + bottom) / 2, text, va="center", color=BESIDE)
    words.set(fontsize=10, linespacing=1.3)


def drawn() -> Figure:
    """Draw both houses side by side, the ground of each at the bottom."""
    core, package = House.read("core"), House.read("package")
    top = max(len(core.rooms), len(package.rooms)) * STEP + 0.3
    left, right = -WIDTH / 2 - REACH - 0.1, APART + WIDTH / 2 + REACH + 0.1
    figure = Figure(figsize=(right - left, top + 0.45))
    ax = figure.add_axes((0, 0, 1, 1))
    ax.set(xlim=(left, right), ylim=(-0.45, top), aspect="equal")
    ax.axis("off")
    column(ax, core, 0.0, -1, "core")
    column(ax, package, APART, 1, "package")
    bridge(ax, core, package)
    ax.text(
        *(
            (left + right) / 2,
            -0.3,
            "An arrow leads from a room to one that it imports: always down."
            " lib.rs and __init__.py make names of every room public.",
        ),
        ha="center",
        color=BESIDE,
        fontsize=10,
    )
    return figure


def main() -> None:
    path: Path = ROOT / "docs/rooms.svg"
    # Equal drawings are equal files.
    with mpl.rc_context({"svg.hashsalt": "crawler2d"}):
        drawn().savefig(path, transparent=True, metadata={"Date": None, "Creator": None})
    print(f"wrote {path.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
