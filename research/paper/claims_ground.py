"""Claims of the paper about what a model gets over: edges, masses, numbers of wheels, forces."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Climb, Drive
from crawler2d.presets import terrains
from crawler2d.presets.robots import engineer
from crawler2d.studies.obstacles import success
from research.paper.claim import Check, Claim, clears, fewer
from research.paper.layouts import layouts
from research.paper.published import TABLE_1
from research.paper.settings import PRESET, STRONG, Setting

if TYPE_CHECKING:
    from crawler2d.parameters.robot import Robot
    from crawler2d.parameters.terrain import Terrain
    from crawler2d.sweeps.found import Found
    from research.paper.design import Work

__all__ = ["chains_stick", "force_is_flat", "gears_end_seizure", "lines_are_flat", "mass_sticks"]

_FIELD = "random step field"
_HEIGHT = 0.04
"""[m] Of the sharp edges: one that all these models clear on a wide step."""


def gears_end_seizure(work: Work) -> Claim:
    """Drive round wheels and gears over edges of two thicknesses, with strong motors."""
    pairs = {
        "line of 3": "line of 3 gears",
        "line of 5": "line of 5 gears",
        "24 all round": "24 gears all round",
        "16 all round, spaced": "16 gears all round, spaced",
    }
    names = [*pairs, *pairs.values(), "belt with grousers"]
    edges = {
        f"{1e3 * thickness:.0f} mm": terrains.knife_edge(_HEIGHT, thickness=thickness)
        for thickness in (0.002, 0.010)
    }
    found = _crossed(work, STRONG, edges, names)
    checks = []
    for edge in edges:
        for plain, gears in pairs.items():
            what = f"{gears} clear an edge {edge} thick"
            check = clears(what, [_count(found, gears, edge)])
            told = f"{check.found}; round wheels: {_told(found, plain, edge)}"
            checks.append(replace(check, found=told))
    belts = ", ".join(_told(found, "belt with grousers", edge, edge) for edge in edges)
    return Claim(
        section="3, 4.1.1",
        text="gears end seizure on sharp edges",
        experiment=f"edges {1e3 * _HEIGHT:.0f} mm high, no flippers, {STRONG.max_torque:g} N m a"
        f" sprocket; a belt with grousers clears {belts}",
        checks=tuple(checks),
    )


def chains_stick(work: Work) -> Claim:
    """Drive a chain over small sharp edges, which fit between its shoes."""
    heights = (0.005, 0.010, 0.020, 0.040)
    edges = {
        f"{1e3 * height:.0f} mm": terrains.knife_edge(height, thickness=0.002) for height in heights
    }
    names = ["chain of 22 shoes", "belt with grousers"]
    checks = []
    for setting in (PRESET, STRONG):
        found = _crossed(work, setting, edges, names)
        own = found.sel(model=names[0])
        ends = own["outcome"].to_numpy()
        pinched = int((own["mechanism"].to_numpy() == "pinched").sum())
        stuck = int((own["jammed"].to_numpy() & (ends != "cleared")).sum())
        counts = ", ".join(_told(found, names[0], edge, edge) for edge in edges)
        checks.append(
            Check(
                what=f"some runs of the chain end in a jam ({setting.max_torque:g} N m)",
                found=f"{stuck} of {ends.size} jammed, {pinched} pinched between shoes; cleared:"
                f" {counts}",
                holds=stuck > 0,
            )
        )
    return Claim(
        section="2.3",
        text="a chain sticks when a sharp or small obstacle gets between its segments",
        experiment="edges 2 mm thick and 5 to 40 mm high, no flippers, chain of 22 shoes",
        checks=tuple(checks),
    )


def mass_sticks(work: Work) -> Claim:
    """Drive lines of round wheels over step fields with twice the mass, and motors to match."""
    known, names = layouts(), ("line of 3", "line of 5")
    motors = replace(PRESET, max_torque=2.0 * PRESET.max_torque)
    built = engineer().without_rotors()
    robots = {}
    for name in names:
        light = motors.on(known[name].on(built))
        robots[name] = light
        robots[f"{name}, twice the mass"] = _heavier(light, 1.0)
        robots[f"{name}, twice mass and torque"] = _heavier(light, 2.0)
    models = {name: {"robot": robot} for name, robot in robots.items()}
    found = _over_fields(work, models, motors.friction)
    checks = [
        fewer(
            f"{name}: {what} clears less",
            _count(found, f"{name}, {what}", _FIELD),
            _count(found, name, _FIELD),
        )
        for what in ("twice the mass", "twice mass and torque")
        for name in names
    ]
    return Claim(
        section="2.2",
        text="a heavy robot sticks more on a line of wheels",
        experiment=f"random step fields, flippers, {motors.max_torque:g} N m a sprocket",
        checks=tuple(checks),
    )


def lines_are_flat(work: Work) -> tuple[Claim, Claim]:
    """Drive lines of 3, 5 and 9 round wheels over step fields, with two kinds of motors."""
    names = ("line of 3", "line of 5", "line of 9")
    more, flat = [], []
    for setting in (PRESET, STRONG):
        known, robot = layouts(), engineer().without_rotors()
        models = {name: {"robot": setting.on(known[name].on(robot))} for name in names}
        found = _over_fields(work, models, setting.friction)
        counts = [_count(found, name, _FIELD) for name in names]
        motors = f"{setting.max_torque:g} N m"
        more.append(fewer(f"3 wheels clear less than 9 ({motors})", counts[0], counts[-1]))
        flat += [
            clears(f"{name} does not clear ({motors})", [count], never=True)
            for name, count in zip(names, counts, strict=True)
        ]
    return (
        Claim(
            section="2.2",
            text="more wheels in a line solve the sticking in part",
            experiment="random step fields, flippers, round wheels; what they cost is below",
            checks=tuple(more),
        ),
        Claim(
            section="2.2",
            text="lines of wheels are suitable only for flat ground",
            experiment="the same runs",
            checks=tuple(flat),
        ),
    )


def force_is_flat(work: Work) -> Claim:
    """Push a robot along by a force, on the flat and off it, beside a belt."""
    grounds: Mapping[str, Terrain] = {
        "flat": terrains.flat(),
        "slope of 35 deg": terrains.ramp(TABLE_1.declared_max_slope),
        "step of 60 mm": terrains.step(0.06),
        "edge of 40 mm": terrains.knife_edge(_HEIGHT),
    }
    forces = ("force on skids", "force on wheels")
    found = _crossed(work, PRESET, grounds, ["belt", *forces])
    checks = []
    for ground in grounds:
        off = [abs(_rate(found, name, ground) - _rate(found, "belt", ground)) for name in forces]
        told = ", ".join(_told(found, name, ground) for name in ("belt", *forces))
        alike = ground == "flat"
        checks.append(
            Check(
                what=f"{ground}: {'as' if alike else 'unlike'} the belt",
                found=told,
                holds=max(off) <= 0.1 if alike else max(off) > 0.5,
            )
        )
    return Claim(
        section="2.1",
        text="a robot driven by a mere force is realistic on flat ground alone",
        experiment="no flippers, the preset; unlike: a rate that differs by more than a half",
        checks=tuple(checks),
    )


def _heavier(robot: Robot, motors: float) -> Robot:
    """Double all masses of a robot; multiply the torque of its motors and of its arms' with it."""
    arms = robot.flippers
    return replace(
        robot,
        mass=2.0 * robot.mass,
        moment_of_inertia=2.0 * robot.moment_of_inertia,
        track_mass=2.0 * robot.track_mass,
        drivetrain=replace(robot.drivetrain, max_torque=motors * robot.drivetrain.max_torque),
        flippers=None
        if arms is None
        else replace(arms, mass=2.0 * arms.mass, torque_limit=motors * arms.torque_limit),
    )


def _crossed(
    work: Work, setting: Setting, grounds: Mapping[str, Any], names: Sequence[str]
) -> Found:
    """Drive layouts without flippers over some grounds."""
    known, bare = layouts(), engineer(flippers=None).without_rotors()
    models = {name: {"robot": setting.on(known[name].on(bare))} for name in names}
    return _driven(work, grounds, models, work.design.claim_repeats)


def _over_fields(work: Work, models: Mapping[str, Any], friction: float) -> Found:
    """Drive robots over as many fields as Table 2 has, and the same ones."""
    field = {_FIELD: terrains.random_stepfield(friction=friction)}
    return _driven(work, field, models, work.design.field_repeats)


def _driven(
    work: Work, grounds: Mapping[str, Any], models: Mapping[str, Any], repeats: int
) -> Found:
    drive = Drive(speed=TABLE_1.max_speed, gait=Climb())
    base = Scenario(engineer().without_rotors(), next(iter(grounds.values())), drive=drive)
    return work.counted(success(base, terrains=grounds, models=models, **work.how(repeats)))


def _count(found: Found, model: str, ground: str) -> tuple[str, int, int]:
    own = found.sel(model=model, terrain=ground)
    return model, int((own["outcome"].to_numpy() == "cleared").sum()), own["count"].item()


def _rate(found: Found, model: str, ground: str) -> float:
    _, cleared, count = _count(found, model, ground)
    return cleared / count if count else math.nan


def _told(found: Found, model: str, ground: str, label: str = "") -> str:
    _, cleared, count = _count(found, model, ground)
    return f"{label or model} {cleared} of {count}"
