"""Replays and sliders for notebooks, tested without one: contents, and effects of changes."""

import sys
from typing import Any

import pytest

import crawler2d as c2d
from tests.shared import ROBOT, refused

WHEELS = ROBOT.with_track(c2d.LineOfWheels(4))
BASE = c2d.Scenario(WHEELS, c2d.terrains.step(0.05), duration=8.0)


def test_a_replay_holds_the_page_of_its_run(run: c2d.Run) -> None:
    assert run.widget().page == run.to_html()
    assert run.widget(time=0.5).page == run.to_html(time=0.5)


def test_a_replay_can_show_another_run(run: c2d.Run) -> None:
    replay = run.widget()
    other = c2d.simulate(BASE)
    replay.show(other)
    assert replay.page == other.to_html()


def test_a_notebook_is_sent_the_page_the_time_and_the_script(run: c2d.Run) -> None:
    state = run.widget().get_state()
    assert {"page", "time", "height", "_esm"} <= set(state)
    assert "export default" in state["_esm"]


def test_a_run_without_history_has_no_widget() -> None:
    summary = c2d.simulate(BASE, duration=0.2, record="summary")
    with pytest.raises(AttributeError, match="no history"):
        summary.widget()


def test_each_move_of_a_slider_is_a_run_with_that_value() -> None:
    found = c2d.explore(BASE, height=(0.02, 0.15), friction=(0.3, 1.2))
    assert list(found.sliders) == ["terrain.height", "terrain.friction"]
    assert [slider.value for slider in found.sliders.values()] == [0.05, 0.9]
    assert (found.scenario, str(found.run.outcome)) == (BASE, "cleared")
    found.sliders["terrain.height"].value = 0.1
    assert found.scenario == BASE.replace({"terrain.height": 0.1})
    assert (found.run.scenario, str(found.run.outcome)) == (found.scenario, "seized")
    assert found.replay.page == found.run.to_html()
    assert found.run.reason.startswith("seized between wheels")
    found.sliders["terrain.friction"].value = 0.5
    changed = {"terrain.height": 0.1, "terrain.friction": 0.5}
    assert found.run.scenario == BASE.replace(changed)


def test_a_run_by_sliders_is_that_of_simulate() -> None:
    found = c2d.explore(BASE, height=(0.02, 0.15))
    found.sliders["terrain.height"].value = 0.07
    alone = c2d.simulate(BASE.replace({"terrain.height": 0.07}))
    assert found.run.metrics == alone.metrics
    assert found.run.reason == alone.reason


def test_a_slider_begins_at_the_nearer_end_if_the_value_is_outside() -> None:
    found = c2d.explore(BASE, height=(0.06, 0.15))
    assert found.sliders["terrain.height"].value == 0.06
    assert found.scenario == BASE.replace({"terrain.height": 0.06})


@pytest.mark.parametrize(
    ("bounds", "given", "begins", "step"),
    [
        ((0.02, 0.15), 0.05, 0.05, 0.001),
        ((0.0, 0.1), 0.05, 0.05, 0.001),
        ((0.02, 0.15), 0.0523, 0.052, 0.001),
        ((0.0, 3.0), 0.05, 0.04, 0.02),
    ],
)
def test_a_slider_shows_the_simulated_value(
    bounds: tuple[float, float], given: float, begins: float, step: float
) -> None:
    found = c2d.explore(BASE.replace({"terrain.height": given}), height=bounds)
    slider = found.sliders["terrain.height"]
    assert (slider.value, slider.step) == (begins, step)
    assert found.run.scenario == BASE.replace({"terrain.height": begins})


def test_whole_numbers_have_whole_sliders_and_paths_name_what_names_do_not() -> None:
    found = c2d.explore(BASE, count=(2, 6), **{"robot.mass": (10.0, 30.0)})
    count, mass = found.sliders.values()
    assert (count.value, count.min, count.max) == (4, 2, 6)
    assert "robot.mass [kg]" in mass.description
    count.value = 5
    assert found.scenario.robot.track == c2d.LineOfWheels(5)


def test_values_that_break_a_rule_keep_the_run_and_say_which() -> None:
    base = BASE.replace({"terrain.edge_radius": 0.03})
    found = c2d.explore(base, height=(0.02, 0.15))
    before = found.run
    found.sliders["terrain.height"].value = 0.02
    assert found.run is before
    assert found.scenario is before.scenario
    assert found._message.value.startswith("terrain.edge_radius must fit the edge")
    assert found._message.layout.display is None
    found.sliders["terrain.height"].value = 0.06
    assert found._message.layout.display == "none"
    assert found.run.scenario == base.replace({"terrain.height": 0.06})


def test_warnings_are_not_repeated_at_every_move() -> None:
    found = c2d.explore(BASE, gravity=(1.0, 40.0))
    found.sliders["gravity"].value = 39.0  # warnings are errors
    assert found.scenario.gravity == 39.0


ARMS = BASE.replace({"robot": c2d.robots.engineer()})


@pytest.mark.parametrize(
    ("base", "ranges", "path"),
    [
        (BASE, {}, "ranges"),
        (BASE, {"hight": (0.02, 0.15)}, "hight"),
        (ARMS, {"mass": (1.0, 2.0)}, "mass"),
        (BASE, {"terrain": (0.0, 1.0)}, "terrain"),
        (BASE, {"name": (0.0, 1.0)}, "robot.name"),
        (BASE, {"terrain.hight": (0.02, 0.15)}, "terrain.hight"),
        (BASE, {"height": (0.15, 0.02)}, "terrain.height"),
        (BASE, {"height": 0.15}, "terrain.height"),
        (BASE, {"height": (0.02, "0.15")}, "terrain.height[1]"),
        (BASE, {"height": (0.02, float("nan"))}, "terrain.height"),
    ],
)
def test_fields_that_cannot_be_varied_are_refused(
    base: c2d.Scenario, ranges: Any, path: str
) -> None:
    assert refused(lambda: c2d.explore(base, **ranges)).path == path


def test_a_misspelt_name_is_answered_with_the_nearest_path() -> None:
    with pytest.raises(
        c2d.ScenarioError, match=r"got \(0\.02, 0\.15\) \(did you mean terrain\.height\?\)"
    ):
        c2d.explore(BASE, hight=(0.02, 0.15))


def test_a_notebook_shows_sliders_and_replay() -> None:
    found = c2d.explore(BASE, height=(0.02, 0.15))
    shown = found._repr_mimebundle_()
    assert "application/vnd.jupyter.widget-view+json" in str(shown)


def test_a_missing_package_names_its_extra(run: c2d.Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "crawler2d.pictures.replay", raising=False)
    monkeypatch.setitem(sys.modules, "anywidget", None)
    with pytest.raises(
        ImportError, match=r"this needs anywidget: pip install 'crawler2d\[notebook\]'"
    ):
        run.widget()
    monkeypatch.setitem(sys.modules, "ipywidgets", None)
    with pytest.raises(
        ImportError, match=r"this needs ipywidgets: pip install 'crawler2d\[notebook\]'"
    ):
        c2d.explore(BASE, height=(0.02, 0.15))
