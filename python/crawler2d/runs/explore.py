"""Sliders over the replay of a run, in a live notebook."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from crawler2d.common.arrays import read_range
from crawler2d.common.extras import extra
from crawler2d.common.keywords import suggestion
from crawler2d.common.units import unit_of
from crawler2d.errors import Crawler2dError, ScenarioError, ignore_warnings
from crawler2d.parameters.fields import is_whole, known_paths, read_path
from crawler2d.parameters.scenario import Scenario, check_scenario
from crawler2d.runs.batch import simulate
from crawler2d.runs.run import Run

__all__ = ["Explorer", "explore"]

# Steps of a slider from one end to the other, at least.
_STEPS = 100


def explore(scenario: Scenario, **ranges: tuple[float, float]) -> Explorer:
    """Change numbers of a scenario with sliders and replay the run.

    Each change simulates the scenario again, which takes at most a tenth of a second for belts and
    round wheels. Sliders start at their value nearest to that of the scenario.

    Parameters
    ----------
    scenario : Scenario
        The initial scenario.
    **ranges : tuple of two floats
        Lowest and highest value of each number: by its name, if no other has that name, such as
        ``height=(0.02, 0.15)``, or by its path, ``**{"terrain.height": (0.02, 0.15)}``.

    Returns
    -------
    Explorer
        Shown by a notebook. Its `run` and `scenario` follow the current values.

    Raises
    ------
    ScenarioError
        If the scenario breaks a rule; if a name is unknown or ambiguous, or belongs to no number;
        if a range is not two increasing numbers.
    ImportError
        If anywidget is missing; the message names the extra to install.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4))
    >>> scenario = c2d.Scenario(robot, c2d.terrains.step(0.05))
    >>> found = c2d.explore(scenario, height=(0.02, 0.15), friction=(0.3, 1.2))
    >>> str(found.run.outcome)
    'cleared'
    >>> found.sliders["terrain.height"].value = 0.1
    >>> str(found.run.outcome), found.scenario.terrain.height
    ('seized', 0.1)
    """
    scenario = check_scenario(scenario)
    if not ranges:
        raise ScenarioError("ranges", None, "must have at least one, such as height=(0.02, 0.15)")
    paths = {_path(scenario, name, bounds): bounds for name, bounds in ranges.items()}
    return Explorer(scenario, {path: read_range(each, path) for path, each in paths.items()})


def _path(scenario: Scenario, name: str, given: object) -> str:
    """Find the path of a number by its last part; errors show what was given for it."""
    known = list(known_paths(scenario))
    found = [name] if "." in name else [p for p in known if p.rpartition(".")[2] == name]
    if not found:
        hint = suggestion(name, [], known)
        raise ScenarioError(name, given, f"must be the name of a number of the scenario{hint}")
    if len(found) > 1:
        rule = f"must be given by the path of one of them: {', '.join(found)}"
        raise ScenarioError(name, given, rule)
    if type(read_path(scenario, found[0])) not in (int, float):
        raise ScenarioError(found[0], read_path(scenario, found[0]), "must be a number to vary")
    return found[0]


class Explorer:
    """Sliders over the replay of a run; see `explore`.

    Attributes
    ----------
    scenario : Scenario
        The scenario with the values of the sliders.
    run : Run
        Its run. If the values break a rule, the previous one, and the notebook shows the rule.
    sliders : dict of str to Widget
        By path.
    replay : Replay
        See `Run.widget`.
    """

    scenario: Scenario
    run: Run

    def __init__(self, scenario: Scenario, ranges: Mapping[str, tuple[float, float]]) -> None:
        widgets = extra("ipywidgets", "notebook")
        self.sliders = {
            path: _slider(widgets, scenario, path, bounds) for path, bounds in ranges.items()
        }
        width = max(len(slider.description) for slider in self.sliders.values())
        for slider in self.sliders.values():
            slider.style.description_width = f"{width}ch"
        self.scenario = scenario.replace(self._values())
        self.run = simulate(self.scenario)
        self.replay = self.run.widget()
        self._message = widgets.Label(layout={"display": "none"})
        self._box = widgets.VBox([*self.sliders.values(), self._message, self.replay])
        for slider in self.sliders.values():
            slider.observe(self._change, names="value")

    def _values(self) -> dict[str, float]:
        return {path: slider.value for path, slider in self.sliders.items()}

    def _change(self, _: object) -> None:
        scenario = self.scenario.replace(self._values())
        try:
            with ignore_warnings():  # at every move of a slider they would fill the notebook
                run = simulate(scenario)
        except Crawler2dError as error:
            self._message.value, self._message.layout.display = str(error), None
            return
        self._message.layout.display = "none"
        self.scenario, self.run = scenario, run
        self.replay.show(run)

    def _repr_mimebundle_(self, **options: Any) -> Any:
        """Show it in a notebook."""
        return self._box._repr_mimebundle_(**options)


def _slider(widgets: Any, scenario: Scenario, path: str, bounds: tuple[float, float]) -> Any:
    """Make a slider that starts at its value nearest to that of the scenario."""
    low, high = bounds
    value = min(max(read_path(scenario, path), low), high)
    look: dict[str, Any] = {"description": _label(path), "layout": {"width": "100%"}}
    if is_whole(scenario, path):
        return widgets.IntSlider(value=round(value), min=round(low), max=round(high), **look)
    step = _round_step((high - low) / _STEPS)
    value = round(low + step * round((value - low) / step), 12)  # 0.05, not 0.05000000000000001
    look["readout_format"] = ".4g"
    return widgets.FloatSlider(value=value, min=low, max=high, step=step, **look)


def _label(path: str) -> str:
    unit = unit_of(path)
    return path if unit in (None, "1") else f"{path} [{unit}]"


def _round_step(most: float) -> float:
    """Return the largest of 1, 2, 5, 10, ... and their tenths that does not exceed `most`."""
    power = math.floor(math.log10(most))
    factor = next(factor for factor in (5, 2, 1) if factor * 10.0**power <= most * (1.0 + 1e-9))
    return float(f"{factor}e{power}")
