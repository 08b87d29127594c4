"""Both robots of a cross-check in one picture."""

from typing import Any

import numpy as np
import pytest
from matplotlib import pyplot as plt

import crawler2d as c2d
from crawler2d.runs.cross_check import CrossCheck
from tests.shared import ROBOT

# Just long enough for a stop: rapier takes most of the time for a jammed robot.
SEIZING = c2d.Scenario(ROBOT.with_track(c2d.LineOfWheels(4)), c2d.terrains.step(0.10), duration=3.6)


@pytest.fixture(scope="module")
def check() -> CrossCheck[c2d.Run]:
    return c2d.simulate(SEIZING).cross_check()


def test_both_robots_their_paths_and_forces_are_in_one_picture(
    check: CrossCheck[c2d.Run],
) -> None:
    side: Any = check.plot()
    lines = {line.get_label(): line for line in side.get_lines()}
    for run, name in ((check.run, "crawler2d's own dynamics"), (check.other, "rapier")):
        assert np.array_equal(lines[f"path in {name}"].get_xydata(), run.position)
    assert "robot in rapier" in lines
    parted = np.asarray(lines[f"1 mm apart, {check.parted_at:.2f} s"].get_xydata())
    assert parted[0].tolist() in check.run.position.tolist()
    legend = side.get_legend()
    assert legend is not None
    said = [text.get_text() for text in legend.get_texts()]
    assert sum(text.startswith("contact force in ") for text in said) == 2
    title = side.get_title(loc="left").replace("\n", " ")
    assert str(check) in title
    left, right = side.get_xlim()
    assert all(left < x < right for run in (check.run, check.other) for x in run.position[:, 0])


def test_it_is_drawn_into_the_axes_it_is_given(check: CrossCheck[c2d.Run]) -> None:
    _, ax = plt.subplots()
    assert check.plot(ax) is ax
    assert len(plt.get_fignums()) == 1
