"""Colours are distinguishable without one type of cone, and lines even without colours."""

import itertools
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib import colors
from matplotlib import pyplot as plt
from numpy.typing import NDArray

import crawler2d as c2d
from crawler2d.drawings import palette
from crawler2d.pictures.rates import LOOKS
from crawler2d.results.outcome import OUTCOMES
from crawler2d.results.record import NO_RESULT
from research.paper.chart import EXCLUDED, TILES
from tests.shared import ROBOT

# Linear RGB as it is seen without L cones (protanopia) or M cones (deuteranopia), which one man in
# fifty has: G. M. Machado et al., IEEE Trans. Vis. Comput. Graph. 15 (2009), table 1, severity 1.
SIGHTS = {
    "usual": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    "protanopia": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deuteranopia": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
}

# Distance in CIELAB. One of 2.3 is just noticed side by side (M. Mahy et al., 1994); lines are thin
# and their legend is elsewhere. Okabe and Ito's palette itself keeps 17.9.
LEAST = 15.0

# From linear sRGB to XYZ (IEC 61966-2-1), and its white.
XYZ = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
WHITE = [0.9505, 1.0, 1.089]


def lab(color: str, sight: str) -> NDArray[np.float64]:
    """CIELAB coordinates of a colour as perceived."""
    given = np.array(colors.to_rgb(color))
    linear = np.where(given <= 0.04045, given / 12.92, ((given + 0.055) / 1.055) ** 2.4)
    x, y, z = np.array(XYZ) @ np.clip(np.array(SIGHTS[sight]) @ linear, 0.0, 1.0) / WHITE
    f = [np.cbrt(v) if v > (6 / 29) ** 3 else v / (3 * (6 / 29) ** 2) + 4 / 29 for v in (x, y, z)]
    return np.array([116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])])


def closest(several: Sequence[str], sight: str) -> float:
    """Return the least distance of two colours."""
    seen = [lab(color, sight) for color in several]
    return min(float(np.linalg.norm(a - b)) for a, b in itertools.combinations(seen, 2))


of_each_sight = pytest.mark.parametrize("sight", SIGHTS)


def test_distances_are_those_of_cielab() -> None:
    # White has L* = 100 and black 0; colours that only the missing cone distinguishes are equal.
    assert closest(["white", "black"], "usual") == pytest.approx(100.0, abs=0.1)
    assert closest(["#ff7f0e", "#2ca02c"], "usual") > 100.0
    assert closest(["#ff7f0e", "#2ca02c"], "protanopia") < 5.0


@of_each_sight
def test_lines_have_colours_that_stay_apart(sight: str) -> None:
    assert closest(palette.LINES, sight) > LEAST


@of_each_sight
def test_surfaces_have_colours_that_stay_apart(sight: str) -> None:
    assert closest(sorted({color for color, _ in LOOKS.values()}), sight) > LEAST
    assert closest([*TILES.values(), EXCLUDED], sight) > LEAST


@of_each_sight
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_pages_have_colours_that_stay_apart(sight: str, scheme: str) -> None:
    page = Path(c2d.__file__).parent / "pictures" / "page" / "page.css"
    part = page.read_text(encoding="utf-8").split("@media (prefers-color-scheme: dark)")
    own = dict(re.findall(r"--([\w-]+): (#\w+);", part[scheme == "dark"]))
    marks = [own[name] for name in ("force", "speed", "intrusion", "stop", "goal")]
    assert closest(marks, sight) > LEAST
    assert closest([own["good"], own["bad"]], sight) > LEAST


def test_without_colours_lines_differ_in_marker_and_neighbours_in_dashes() -> None:
    looks = [palette.look_of(index) for index in range(10)]
    assert len({look["marker"] for look in looks}) == len(looks)
    assert all(a["linestyle"] != b["linestyle"] for a, b in itertools.pairwise(looks[:7]))
    assert len({(look["color"], look["linestyle"]) for look in looks}) == len(looks)


def test_every_outcome_has_its_own_colour_and_hatching() -> None:
    assert set(LOOKS) == {*OUTCOMES, *NO_RESULT}
    assert len(set(LOOKS.values())) == len(LOOKS)


def test_the_style_of_lines_is_the_palette() -> None:
    with plt.style.context("crawler2d.lines"):
        cycle = list(plt.rcParams["axes.prop_cycle"])
    looks = [palette.look_of(index) for index in range(len(palette.LINES))]
    assert [(look["color"], look["linestyle"]) for look in cycle] == [
        (look["color"], look["linestyle"]) for look in looks
    ]


def test_the_style_changes_nothing_that_the_package_draws() -> None:
    wheels = ROBOT.with_track(c2d.LineOfWheels(4, wheel_radius=0.0608))
    run = c2d.simulate(wheels, c2d.terrains.step(0.075), duration=1.0)

    def drawn() -> list[tuple[Any, ...]]:
        axes = [run.plot(), *run.plot_history(), wheels.plot(), run.scenario.plot()]
        looks = [
            (line.get_color(), line.get_marker(), line.get_linestyle())
            for ax in axes
            for line in ax.get_lines()
        ]
        # A mark has no line, and takes any.
        return [look if look[1] == "None" else look[:2] for look in looks]

    usual = drawn()
    with plt.style.context("crawler2d.lines"):
        assert drawn() == usual
