"""Slip in proportion to the force on a track, which files may state and robots here do not have."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from crawler2d.model_tree import Where
from crawler2d.reading.engines import is_first_along
from crawler2d.reading.log import ReadLog, lines, span
from crawler2d.reading.running_gear import SideView
from crawler2d.reading.wheels import Runner

__all__ = ["warn_of_slip"]


def warn_of_slip(log: ReadLog, runners: Sequence[Runner], view: SideView) -> None:
    """Warn if tracks of the file slip along the track below the limit of friction, too."""
    stated = [*_of_shapes(runners, view), *_of_plugins(log)]
    if stated:
        value = f"{span(slip for slip, _ in stated)} m/s per N"
        reason = "is not used: here a track slips at the limit of friction alone"
        log.add_warning(f"{lines(where for _, where in stated)}: slip", value, reason)


def _of_shapes(runners: Sequence[Runner], view: SideView) -> Iterator[tuple[float, Where]]:
    for runner in runners:
        for friction in (shape.friction for shape in runner.surfaces):
            if friction is not None and friction.slips:
                slip, where = friction.slips[0 if is_first_along(runner, friction, view) else 1]
                if slip > 0.0:
                    yield slip, where


def _of_plugins(log: ReadLog) -> Iterator[tuple[float, Where]]:
    for plugin in log.tree.plugins:
        if plugin.is_one_of("wheelslip"):
            slips = plugin.numbers("wheel/slip_compliance_longitudinal")
            yield from ((slip, where) for slip, where in slips if slip > 0.0)
