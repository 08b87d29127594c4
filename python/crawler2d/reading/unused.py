"""Figures of a file that change a robot in its simulator, and are not used here."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator, Sequence

from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Where
from crawler2d.reading.engines import is_first_along
from crawler2d.reading.log import ReadingWarning, ReadLog, lines, span
from crawler2d.reading.parsing import Element
from crawler2d.reading.running_gear import SideView
from crawler2d.reading.wheels import Runner

__all__ = ["warn_of_gravity", "warn_of_slip", "warn_of_unmoved"]

_GRAVITY = (0.0, 0.0, -9.81)  # [m/s^2] Default of a scenario.
_NEAR = 0.01  # of gravity, as files have 9.8 or a local value

_OF_LINKS = ("link", "gazebo")
"""What contains settings of a link: in SDF itself, in URDF an extension, which Gazebo copies."""


def warn_of_gravity(
    element: Element, attribute: str | None, warnings: list[ReadingWarning]
) -> None:
    """Warn of gravity that differs from that of a scenario; what is no vector is passed over."""
    with contextlib.suppress(ScenarioError):
        vector = element.reals(3, attribute)
        if math.dist(vector, _GRAVITY) > _NEAR * math.hypot(*_GRAVITY):
            path = element.at if attribute is None else f"{element.at}@{attribute}"
            value = " ".join(f"{each:g}" for each in vector)
            reason = "is not used: here gravity is 9.81 m/s^2 downwards, or Scenario.gravity"
            warnings.append((path, value, reason))


def warn_of_unmoved(model: Element, warnings: list[ReadingWarning]) -> None:
    """Warn of links without gravity, and of links of SDF and URDF that no force moves."""
    every = list(model.within())
    weightless = [
        each
        for each in every
        if (_is_of_link(each, "gravity") and each.text.lower() in ("0", "false"))
        or (each.tag == "turnGravityOff" and each.text.lower() in ("1", "true"))
        or (each.tag == "body" and each.attributes.get("gravcomp", "0").strip(" 0.") != "")
    ]
    kinematic = [
        each
        for each in every
        if _is_of_link(each, "kinematic") and each.text.lower() in ("1", "true")
    ]
    for found, what, reason in (
        (weightless, "without gravity", "here every link has its weight"),
        (kinematic, "that no force moves", "here forces move every link"),
    ):
        if found:
            path = f"{found[0].at}@gravcomp" if found[0].tag == "body" else found[0].at
            warnings.append((path, f"{len(found)} {what}", f"is not used: {reason}"))


def _is_of_link(element: Element, tag: str) -> bool:
    parent = element.parent
    return element.tag == tag and parent is not None and parent.tag in _OF_LINKS


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
