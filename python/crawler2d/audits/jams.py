"""Find, before any run, which repairs can jam at all where a robot seized."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from crawler2d import _core
from crawler2d.errors import ScenarioError, ignore_warnings
from crawler2d.parameters.fields import read_path

if TYPE_CHECKING:
    from crawler2d.parameters.scenario import Scenario

__all__ = ["free_of_jams"]

_DEPTH = 1e-3
"""[m] Ground less deep inside the track also holds a belt."""

_MOST = 10.0
"""[-] Largest friction of a floor."""


def free_of_jams(
    candidates: Sequence[Mapping[str, Any]], scenarios: Sequence[Scenario]
) -> list[int]:
    """Find the candidates that cannot jam on three contacts in any of some scenarios.

    Parameters
    ----------
    candidates : sequence of mapping of str to object
        Values that each replaces in a scenario.
    scenarios : sequence of Scenario
        Runs in which the robot seized. Those whose jams cannot be computed are skipped, such as
        different ground under the two tracks.

    Returns
    -------
    list of int
        Their indices; empty if nothing can be computed.

    Examples
    --------
    Five wheels cannot jam on a step of 75 mm, but four can:

    >>> import crawler2d as c2d
    >>> robot = c2d.robots.engineer(flippers=None)
    >>> base = c2d.Scenario(robot, c2d.terrains.step(0.075))
    >>> wheels = [c2d.LineOfWheels(count, wheel_radius=0.0608) for count in (4, 5)]
    >>> free_of_jams([{"robot.track": track} for track in wheels], [base])
    [1]
    """
    left = list(range(len(candidates)))
    is_known = False
    for scenario in scenarios:
        if not left:
            break
        try:
            with ignore_warnings():  # they are in the lint
                texts = [scenario.replace(candidates[place]).to_json() for place in left]
                found = _core.jam_ranges(texts, _MOST)
        except ScenarioError:
            continue
        is_known = True
        friction = float(read_path(scenario, "terrain.friction"))
        left = [
            place for place, jams in zip(left, found, strict=True) if not _holds(jams, friction)
        ]
    return left if is_known else []


def _holds(jams: Mapping[str, Any], friction: float) -> bool:
    """Whether one of these jams is in a pocket and holds at a friction."""
    inside = jams["depth"] > _DEPTH
    return bool((inside & (jams["low"] <= friction) & (friction <= jams["high"])).any())
