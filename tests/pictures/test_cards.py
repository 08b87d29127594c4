"""Robots and scenarios in notebooks and as text."""

import dataclasses
import subprocess
import sys
import warnings
import xml.etree.ElementTree as ET
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.parameters import settings, terrain
from tests.shared import ROBOT, TRAPEZOID, VARIANTS

HOSTILE = "</td><script>alert(1)</script> & \" ' \u2028 \ud800"


def parsed(shown: Any) -> ET.Element:
    """The card as a tree; it is XML, too."""
    html = shown._repr_html_()
    assert html is not None
    return ET.fromstring(html)


@pytest.mark.parametrize("scenario", VARIANTS.values(), ids=VARIANTS)
def test_every_robot_and_scenario_has_a_small_card(scenario: Any) -> None:
    for shown in (scenario, scenario.robot):
        card = parsed(shown)
        (drawing,) = card.iter("{http://www.w3.org/2000/svg}svg")
        assert len(drawing) > 2
        values = [cell.text for cell in card.iter("td")]
        assert len(values) >= 6
        assert all(values)
        assert len(shown._repr_html_()) < 50_000


def test_a_card_has_the_figures_that_matter_with_their_units() -> None:
    def rows(shown: Any) -> dict[str | None, str | None]:
        card = parsed(shown)
        return {
            name.text: value.text
            for name, value in zip(card.iter("th"), card.iter("td"), strict=True)
        }

    robot = rows(c2d.robots.engineer())
    assert robot["mass"] == "21.2 kg, of which tracks 2.4 kg"
    assert robot["axle distance"] == "0.365 m"
    assert robot["radius"] == "0.064 m"
    assert robot["flippers"] == "0.34 m long, at the front"
    scenario = rows(VARIANTS["flippers-climb"])
    assert scenario["terrain"] == "Step(height=0.06, edge_radius=0.002)"
    assert scenario["gait"] == "climb"
    assert scenario["goal"] == "x = 0 m"


@pytest.mark.parametrize(
    ("by_segment", "shown"),
    [
        (None, "0.9"),
        ([0.4, 0.4, 0.4], "0.4"),
        ([0.9, 0.2, 0.9], "0.2 and 0.9"),
        ([0.9, 0.2, 0.5], "0.2 to 0.9"),
    ],
)
def test_the_friction_of_a_card_is_that_of_the_segments(
    by_segment: list[float] | None, shown: str
) -> None:
    points = [(-2.0, 0.0), (0.0, 0.0), (0.0, 0.05), (2.0, 0.05)]
    ground = c2d.terrains.from_points(points, goal=0.0, segment_friction=by_segment)
    cells = [cell.text for cell in parsed(c2d.Scenario(ROBOT, ground)).iter("td")]
    assert shown in cells


@pytest.mark.parametrize("robot", [ROBOT, TRAPEZOID])
def test_the_drawing_of_a_card_has_the_outline_of_the_belt(robot: c2d.Robot) -> None:
    (drawing,) = parsed(robot).iter("{http://www.w3.org/2000/svg}svg")
    paths = [path.get("d") or "" for path in drawing.iter("{http://www.w3.org/2000/svg}path")]
    steps = [path.rstrip("Z").replace("M", "").split("l") for path in paths if "Z" in path]
    corners = max((np.array([p.split() for p in s], float).cumsum(0) for s in steps), key=len)
    discs = np.array(robot.outline.discs)
    low, high = (
        (discs[:, :2].T - discs[:, 2]).min(axis=1),
        (discs[:, :2].T + discs[:, 2]).max(axis=1),
    )
    length, height = (high - low).tolist()
    # A twenty-fifth of the width is margin; corners are rounded to tenths of a pixel.
    scale = 360.0 / (1.04 * length)
    assert np.ptp(corners, axis=0) == pytest.approx([scale * length, scale * height], abs=0.2)


def test_an_invalid_object_is_shown_as_text() -> None:
    broken = dataclasses.replace(ROBOT, mass=-1.0)
    assert broken._repr_html_() is None
    assert c2d.Scenario(broken, c2d.terrains.flat())._repr_html_() is None
    assert repr(broken).startswith("Robot(")


def test_a_hostile_name_stays_a_name() -> None:
    robot = dataclasses.replace(ROBOT, name=HOSTILE.replace("\ud800", ""))
    for shown in (robot, c2d.Scenario(robot, c2d.terrains.flat())):
        assert list(parsed(shown).iter("script")) == []


def test_a_card_warns_of_nothing() -> None:
    tall = c2d.Scenario(ROBOT, c2d.terrains.step(75.0))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert tall._repr_html_()
    with pytest.warns(c2d.ScenarioWarning, match=r"terrain\.height"):
        tall.plot()


def test_a_card_needs_no_matplotlib() -> None:
    code = """
import sys
sys.modules["matplotlib"] = None
import crawler2d as c2d
robot = c2d.robots.absolem()
assert "<svg" in robot._repr_html_()
assert "<svg" in c2d.Scenario(robot, c2d.terrains.stairs())._repr_html_()
try:
    robot.plot()
except ImportError as error:
    assert "pip install 'crawler2d[plot]'" in str(error), error
else:
    raise AssertionError
"""
    subprocess.run([sys.executable, "-c", code], check=True)


NAMES = {**vars(c2d), **vars(terrain), **vars(settings)}


@pytest.mark.parametrize("scenario", VARIANTS.values(), ids=VARIANTS)
def test_the_text_of_an_object_makes_an_equal_one(scenario: Any) -> None:
    assert eval(repr(scenario), dict(NAMES)) == scenario


def test_a_repr_leaves_out_defaults_but_names_the_models() -> None:
    scenario = c2d.Scenario(ROBOT, c2d.terrains.step(0.1), drive=c2d.Drive(speed=0.3))
    text = repr(scenario)
    assert text.endswith("terrain=Step(height=0.1), drive=Drive(speed=0.3))")
    assert "track=BeltTrack()" in text
    assert "solver" not in text
    assert len(text) < 700
    assert repr(c2d.LineOfWheels(4)) == "LineOfWheels(count=4, wheel=RoundWheel())"
