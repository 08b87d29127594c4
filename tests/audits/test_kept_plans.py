"""Plans of an audit before it runs, from lengths only, are as in `kept`, line by line."""

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

import crawler2d as c2d
from crawler2d.audits.candidates import candidates_of, pockets, wheel_count
from crawler2d.audits.runs import belt_of, scenario_of
from crawler2d.audits.sampling import assumptions_of, order_by_risk
from crawler2d.audits.subject import standard_obstacles, subject_of, unknown_of, vary_of
from crawler2d.variation.distributions import Ranges
from tests.audits.seizing import SEIZING
from tests.kept import check_kept
from tests.reading.carts import FILES

KEPT = Path(__file__).parent / "kept"
PLACED = c2d.HybridWheels(
    ((-0.18, 0.0, 0.064), (-0.06, 0.01, 0.05), (0.05, 0.0, 0.05), (0.18, 0.0, 0.064))
)


def with_arms(track: c2d.LineOfWheels | c2d.HybridWheels) -> c2d.Robot:
    """A robot whose arms at both ends have their own wheels."""
    arms = c2d.robots.engineer().flippers
    assert arms is not None
    return c2d.robots.engineer(
        flippers=replace(arms, ends="both", track=track), track=c2d.LineOfWheels(4)
    )


def smooth(robot: c2d.Robot) -> c2d.Robot:
    """The same without grousers, so that gear wheels need their own heights."""
    return replace(robot, outline=replace(robot.outline, grouser_height=0.0, grouser_thickness=0.0))


ROBOTS: dict[str, c2d.Robot] = {
    "line": SEIZING,
    "large": SEIZING.with_track(c2d.LineOfWheels(9)),
    "smooth": smooth(SEIZING.with_track(c2d.LineOfWheels(3))),
    "placed": SEIZING.with_track(PLACED),
    "one": SEIZING.with_track(c2d.HybridWheels(((0.0, 0.0, 0.064),))),
    "bare": c2d.robots.marv(track="public"),
    "round": SEIZING.with_track(c2d.CircumferentialWheels(12, wheel_radius=0.03)),
    "gears": SEIZING.with_track(c2d.LineOfWheels(4, wheel=c2d.GearWheel())),
    "arms": with_arms(c2d.LineOfWheels(3)),
    "placed arms": with_arms(c2d.HybridWheels(((0.05, 0, 0.05), (0.12, 0, 0.045), (0.2, 0, 0.04)))),
    "belts": c2d.robots.engineer(),
    "absolem": c2d.robots.absolem(track="public"),
}


def told(ranges: Ranges) -> Iterator[str]:
    optional = [path for path in ranges if path in ranges.optional]
    yield from repr(ranges).splitlines()
    yield f"optional: {', '.join(optional)}"


def plan(robot: c2d.Robot) -> Iterator[str]:
    """Describe the audit of a robot before the first run."""
    belt = belt_of(robot)
    yield f"belt: {belt.reason}, {belt.robot.track}"
    if belt.robot.flippers is not None:
        yield f"belt of the flippers: {belt.robot.flippers.track}"
    found = pockets(robot)
    yield from map(str, found)
    grounds = standard_obstacles(robot, 0.75)
    yield from (f"{name}: {ground}" for name, ground in grounds.items())
    yield f"in this order: {', '.join(order_by_risk(grounds, found))}"
    scenario = scenario_of(robot, next(iter(grounds.values())), None, None)
    yield f"{scenario.drive}, {scenario.start}, {scenario.duration} s"
    for carriers in (["chassis"], ["flippers"], ["chassis", "flippers"]):
        yield f"candidates for {' and '.join(carriers)}:"
        for each in candidates_of(robot, carriers):
            arms = each.robot.flippers
            own = "" if arms is None else f", flippers {arms.track}"
            yield f"  {each.change} {each.kind}, {wheel_count(each.robot)}: {each.description}"
            yield f"    {each.robot.track}{own}"
    for name, ranges in assumptions_of(robot, {}).items():
        yield f"assumed: {name}"
        yield from told(ranges)


def rounded(lines: Iterator[str]) -> str:
    """Remove digits that depend on rounding."""
    text = "\n".join(lines)
    return re.sub(r"-?\d+\.\d+(e-?\d+)?", lambda found: f"{round(float(found[0]), 9):g}", text)


@pytest.mark.parametrize("name", ROBOTS)
def test_the_plan_of_an_audit_is_as_kept(name: str) -> None:
    check_kept(KEPT / f"plan-{name.replace(' ', '-')}.txt", rounded(plan(ROBOTS[name])))


def test_what_varies_and_what_is_unknown_is_as_kept() -> None:
    lines: list[str] = []
    scheduled = c2d.Drive(schedule=((0.0, 0.1),))
    for name, ranges in (
        ("vary", vary_of()),
        ("vary, of a drive", vary_of(c2d.Drive(speed=0.2))),
        ("vary, of a schedule", vary_of(scheduled)),
        ("of a robot", unknown_of(subject_of(SEIZING, {}), with_friction=True)),
        ("of a robot, not its floor", unknown_of(subject_of(SEIZING, {}), with_friction=False)),
    ):
        lines += [f"{name}:", *told(ranges)]
    for suffix, engine in (("sdf", "gz"), ("urdf", "gz"), ("sdf", "mujoco")):
        path = FILES / f"cart.{suffix}"
        for how in ({}, {"ground_friction": 0.6}):
            subject = subject_of(str(path), {"engine": engine, **how})  # type: ignore[typeddict-item]
            for with_friction in (True, False):
                lines += [f"{path.name}, {engine}, {how}, {with_friction}:"]
                lines += told(unknown_of(subject, with_friction=with_friction))
    check_kept(KEPT / "plan-unknowns.txt", rounded(iter(lines)))
