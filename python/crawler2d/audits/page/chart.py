"""The chart of an audit: step heights and frictions at which the model can jam."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from crawler2d.audits.runs import scenario_of
from crawler2d.drawings.svg import Sheet, escape
from crawler2d.errors import ScenarioError, ignore_warnings
from crawler2d.parameters.terrain import Step
from crawler2d.pictures.jams import JamRegion, jam_regions
from crawler2d.studies.jams import jam_chart

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from crawler2d.parameters.robot import Robot

__all__ = ["chart_section"]

_HEIGHTS = 60
_WIDTH, _HEIGHT = 460.0, 240.0  # [px] of the axes
_LEFT, _BELOW, _AROUND = 46.0, 42.0, 16.0  # [px] round them
_MOST = 1.5  # friction
_SHADES = 6  # of pairs of wheels

_ABOUT = (
    "Heights and frictions of a step at which the model can stand still on three contacts with its"
    " motors running; computed, not sampled. Outside the coloured areas there is no such pose;"
    " inside, the robot jams if it gets into one. Motor torque is unlimited, flippers are raised as"
    " in front of the obstacles."
)


def chart_section(robot: Robot, others: Sequence[tuple[str, Robot]] = ()) -> str:
    """Draw the charts of a robot and of other named ones."""
    figures, missing = "", ""
    for name, each in (("the model", robot), *others):
        try:
            figures += _figure(name, each)
        except ScenarioError as error:
            whose = "" if each is robot else f" for {escape(name)}"
            missing += f"<p>Not computed{whose}: {escape(str(error))}.</p>"
    drawn = f'<p class="about">{_ABOUT}</p><div class="charts">{figures}</div>' if figures else ""
    return drawn + missing


def _figure(name: str, robot: Robot) -> str:
    most = 2.0 * robot.outline.front_radius
    heights = [most * (k + 1) / _HEIGHTS for k in range(_HEIGHTS)]
    with ignore_warnings():  # they are in the lint
        scenario = scenario_of(robot, Step(height=most), None, None)
        data = jam_chart(scenario, values=heights, most_friction=_MOST)
    regions = jam_regions(data.isel(model=0))
    box = -_LEFT, _WIDTH + _AROUND, -_BELOW, _HEIGHT + _AROUND
    sheet = Sheet(box, box[1] - box[0], box[3] - box[2])
    scale = np.array([_WIDTH / most, _HEIGHT / _MOST])
    for region in regions:
        for piece in region.pieces:
            if len(piece) > 2:
                sheet.line(scale * piece, f'class="{_class(region)}"')
    for place, text, look in _ticks(most):
        sheet.label(place, text, f'class="tick" {look}')
    corners = [(0.0, 0.0), (_WIDTH, 0.0), (_WIDTH, _HEIGHT), (0.0, _HEIGHT)]
    sheet.line(corners, 'class="axes"')
    keys = "".join(
        f'<li><span class="swatch {_class(each)}"></span> {escape(each.text)}</li>'
        for each in regions
    )
    keys = keys or "<li>It can jam nowhere.</li>"
    svg = sheet.svg(f"where {name} can jam on a step, by height and friction")
    return f"<figure>{svg}<figcaption>{escape(name)}<ul>{keys}</ul></figcaption></figure>"


def _class(region: JamRegion) -> str:
    if region.is_belt:
        return "of-belt"
    return "of-none" if region.place is None else f"of-pair-{region.place % _SHADES}"


def _ticks(most: float) -> Iterator[tuple[tuple[float, float], str, str]]:
    """Place numbers and names of both axes."""
    step = 0.02 if most < 0.2 else 0.1
    middle = 'text-anchor="middle"'
    for k in range(1, int(most / step + 1e-9) + 1):
        yield (_WIDTH * k * step / most, -15.0), f"{1e3 * k * step:.0f}", middle
    yield (0.5 * _WIDTH, -34.0), "height of the step [mm]", middle
    for friction in (0.5, 1.0, 1.5):
        yield (-6.0, _HEIGHT * friction / _MOST - 4.0), f"{friction:g}", 'text-anchor="end"'
    yield (-6.0, -4.0), "0", 'text-anchor="end"'
    yield (6.0, _HEIGHT - 14.0), "friction", 'text-anchor="start"'
