"""The chart of an audit: its input and its drawing."""

import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.audits.page import chart
from crawler2d.audits.page.chart import chart_section
from crawler2d.pictures.jams import JamRegion
from tests.audits.seizing import SEIZING
from tests.kept import check_kept

KEPT = Path(__file__).parent / "kept"


def region(corners: list[tuple[float, float]], **changed: Any) -> JamRegion:
    usual = {"text": "a & b", "place": 7, "is_belt": False, "pieces": [np.array(corners)]}
    return JamRegion(**{**usual, **changed})


def test_a_chart_draws_each_region_in_its_place(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two regions of two pairs, one without a pair, one of the belt, and pieces without area."""
    robot = replace(SEIZING, name="charted")
    most = 2.0 * robot.outline.front_radius
    asked: list[Any] = []

    def jams(scenario: c2d.Scenario, **how: Any) -> Any:
        asked.append((scenario, how))
        return SimpleNamespace(isel=lambda **at: at)

    def regions(at: Any) -> list[JamRegion]:
        assert at == {"model": 0}
        return [
            region([(0.0, 0.0), (most, 0.0), (most, 1.5), (0.0, 1.5)]),
            region([(0.0, 0.0), (most, 1.5)], place=3, text="nothing to draw"),
            region([(0.0, 0.0), (0.5 * most, 0.75), (0.0, 0.75)], place=None, text="others"),
            region([(0.0, 0.0), (0.5 * most, 0.75), (0.5 * most, 0.0)], is_belt=True, text="belt"),
        ]

    monkeypatch.setattr(chart, "jam_chart", jams)
    monkeypatch.setattr(chart, "jam_regions", regions)
    small = replace(robot, outline=replace(robot.outline, front_radius=0.12, rear_radius=0.12))
    large = small.with_track(c2d.BeltTrack())
    text = chart_section(robot, [("<larger>", large)])
    check_kept(KEPT / "chart.html", re.sub(r"(?<=>)(?=<)", "\n", text))
    (scenario, how), (other, _) = asked
    assert scenario.terrain == c2d.terrains.step(most)
    assert other.terrain == c2d.terrains.step(0.24)
    assert how == {
        "values": pytest.approx([most * k / 60 for k in range(1, 61)]),
        "most_friction": 1.5,
    }


def test_a_chart_of_no_jams_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(chart, "jam_regions", lambda _: [])
    text = chart_section(replace(SEIZING, name="free"))
    assert text.endswith(
        "</svg><figcaption>the model<ul><li>It can jam nowhere.</li></ul></figcaption></figure>"
        "</div>"
    )


def test_a_chart_that_cannot_be_computed_says_whose_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any, **__: Any) -> Any:
        raise c2d.ScenarioError("robot.track", "<gears>", "must be round wheels")

    monkeypatch.setattr(chart, "jam_chart", refuse)
    robot = replace(SEIZING, name="refused")
    other = replace(robot, mass=21.0)
    why = "robot.track must be round wheels, got &lt;gears&gt;."
    assert chart_section(robot, [("<other>", other)]) == (
        f"<p>Not computed: {why}</p><p>Not computed for &lt;other&gt;: {why}</p>"
    )
