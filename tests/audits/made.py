"""Audits with made-up runs, whose reports do not depend on physics."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

import crawler2d as c2d
from crawler2d.audits.candidates import candidates_of, pockets
from crawler2d.audits.lint import lint
from crawler2d.audits.record import AuditRecord, Call
from crawler2d.audits.repairs import LEVEL, RepairSearch, assess
from crawler2d.audits.runs import belt_of, round_speeds, scenario_of
from crawler2d.audits.sampling import Assumption
from crawler2d.audits.subject import subject_of, unknown_of, vary_of
from crawler2d.audits.verdicts import BELT, OWN, Proportion, verdict_of
from crawler2d.parameters.terrain import Terrain
from crawler2d.variation.distributions import Levels, Ranges
from tests.audits.seizing import seizing_file

SAMPLES, REPEATS = 40, 2
DIMS = ("model", "terrain", "sample", "repeat")

OBSTACLES: dict[str, Terrain] = {
    "step of 75 mm": c2d.terrains.step(0.075),
    "gap of 100 mm": c2d.terrains.gap(0.1),
    "stairs": c2d.terrains.stairs(count=3, rise=0.05, run=0.2),
    "kerb": c2d.terrains.step(0.03, edge_radius=0.02),
    "<ramp> & more": c2d.terrains.ramp(0.3),
    "knife edge": c2d.terrains.step(0.0512345678),
}
ENDS: dict[str, tuple[dict[str, int], dict[str, int]]] = {
    "step of 75 mm": ({"seized": 30, "cleared": 10}, {"cleared": 40}),
    "gap of 100 mm": ({"seized": 20, "slipping": 20}, {"cleared": 30, "tipped_over": 10}),
    "stairs": ({"hung_up": 20, "seized": 20}, {"cleared": 2, "hung_up": 38}),
    "kerb": ({"cleared": 40}, {}),
    "<ramp> & more": ({"cleared": 12, "slipping": 28}, {"cleared": 38, "diverged": 2}),
    "knife edge": ({"cleared": 37, "seized": 1, "failed": 2}, {"cleared": 40}),
}
"""How many samples of the robot, and of the robot on belts, end in which way."""


def outcomes(counts: dict[str, int]) -> list[str]:
    ends = [name for name, count in counts.items() for _ in range(count)]
    return ends or [""] * SAMPLES


def runs_of(name: str, robots: dict[str, list[str]], speeds: Any) -> xr.Dataset:
    """Runs over one obstacle, with values that differ between runs."""
    ends = np.array([[[[end] * REPEATS for end in each]] for each in robots.values()])
    number = np.arange(ends.size).reshape(ends.shape)
    is_made = ends != ""
    columns: dict[str, Any] = {
        "outcome": ends,
        "stop_bodies": np.where(number % 7 < 5, "1-2", "0-1"),
        "stop_carrier": np.full(ends.shape, "chassis"),
        "time": np.where(is_made, 2.0 + 0.01 * number, np.nan),
        "wall_time": np.where(is_made, 0.1 + 0.002 * number, np.nan),
        "unknown_friction": np.where(is_made, 0.5 + 0.005 * (number % 80), np.nan),
        "tried_closed_track": ends == "seized",
        "freed_by_closed_track": number % 2 == 0,
        "tried_closed_track_clear_of_the_ground": ends == "seized",
        "freed_by_closed_track_clear_of_the_ground": number % 3 == 0,
        "tried_torque_x2": number % 4 == 0,
        "freed_by_torque_x2": number < 0,
        "tried_friction_x2": number % 4 > 0,
        "freed_by_friction_x2": number % 5 == 0,
    }
    turn = np.add.outer(np.arange(SAMPLES), np.arange(REPEATS))
    at = {
        "model": list(robots),
        "terrain": [name],
        "speed": (("sample", "repeat"), speeds[turn % len(speeds)]),
    }
    paths = {"unknown_friction": {"path": "terrain.friction"}}
    variables = {key: (DIMS, value, paths.get(key)) for key, value in columns.items()}
    return xr.Dataset(variables, at)


def made_of_file(folder: Path) -> AuditRecord:
    """An audit of a file that seizes, with all kinds of verdicts and three repairs."""
    path = folder / "cart.urdf"
    mass = '<mass value="8"/>'
    text = seizing_file().replace(mass, f'<origin xyz="-0.024 0 0.068"/>{mass}')
    path.write_text(text, encoding="utf-8")
    own = subject_of(str(path), {})
    robot = own.robot
    vary = vary_of() | {"terrain.height": c2d.scaled(0.9, 1.1)}
    levels = vary["drive.speed"]
    assert isinstance(levels, Levels)
    scenario = scenario_of(robot, OBSTACLES["step of 75 mm"], None, None)
    speeds = round_speeds(scenario.drive.speed * np.array(levels.factors))
    tables = {
        name: runs_of(name, {OWN: outcomes(ours), BELT: outcomes(belts)}, speeds)
        for name, (ours, belts) in ENDS.items()
    }
    unknown = unknown_of(own, with_friction=True)
    return AuditRecord(
        robot=robot,
        reading=own.reading,
        lint=lint(robot, own.reading),
        pockets=pockets(robot),
        belt=belt_of(robot),
        obstacles=OBSTACLES,
        vary=vary,
        unknown=unknown,
        drive=scenario.drive,
        call=Call(samples=SAMPLES, repeats=REPEATS, seed=3, repair=True),
        verdicts=tuple(verdict_of(table, name) for name, table in tables.items()),
        assumed=assumed(),
        repaired=searched(robot, speeds),
        table=xr.concat(tables.values(), "terrain").assign_attrs(vary="speed", unknown="friction"),
    )


def assumed() -> tuple[Assumption, ...]:
    rotor = Ranges({"robot.drivetrain.rotor_inertia": c2d.uniform(0.01, 0.1)})
    impacts = Ranges({"restitution": c2d.uniform(0.0, 1.0)})
    two = ("step of 75 mm", "gap of 100 mm")
    return (
        *(
            Assumption(obstacle=name, assumption="rotor", drawn=rotor, seized=0, runs=18)
            for name in two
        ),
        Assumption(obstacle=two[0], assumption="restitution", drawn=impacts, seized=9, runs=18),
    )


def searched(robot: c2d.Robot, speeds: Any) -> RepairSearch:
    """Confirmed wheels and belts, and unconfirmed gears."""
    every = candidates_of(robot, ["chassis"])
    wheels = next(each for each in every if each.kind == "wheels")
    gears = next(each for each in every if each.kind == "gears")
    belt = belt_of(robot)
    belts = replace(
        wheels, description=f"belts ({belt.reason})", kind="belt", robot=belt.robot, change=5
    )
    names = ("step of 75 mm", "gap of 100 mm")
    chosen = (wheels, gears, belts)
    cleared, nothing = ["cleared"] * SAMPLES, ["slipping"] * SAMPLES
    ways = {
        OWN: (cleared, cleared, cleared),
        wheels.description: (cleared, cleared, cleared),
        gears.description: (["seized"] * 20 + ["cleared"] * 20, cleared, cleared),
        belts.description: (cleared, cleared[:36] + nothing[:4], cleared),
    }
    table = xr.concat(
        [
            runs_of(name, {each: ends[k] for each, ends in ways.items()}, speeds)
            for k, name in enumerate((*names, LEVEL))
        ],
        "terrain",
    )
    found = [assess(table, each, names, names, belts.description) for each in chosen]
    return RepairSearch(tuple(found), 7, table)


def doubtful(audit: AuditRecord) -> AuditRecord:
    """The same with an error of lint, one certain verdict less, and no confirmed repair."""
    error = replace(audit.lint[0], severity="error")
    warnings = tuple(replace(error, severity="warning", where="") for _ in range(2))
    unsure = tuple(
        replace(each, result="not certain" if each.jam_wheels else each.result)
        for each in audit.verdicts
    )
    assert audit.repaired is not None
    none = {"gap of 100 mm": Proportion()}
    lost = tuple(
        replace(each, confirmed=False, cleared_given_belt={**each.cleared_given_belt, **none})
        for each in audit.repairs
    )
    reading = {"engine": "gz", "packages": {"a": "b"}, "lenient": True}
    return replace(
        audit,
        lint=(error, *warnings, *audit.lint),
        verdicts=unsure,
        assumed=audit.assumed[:1],
        repaired=audit.repaired._replace(repairs=lost),
        call=replace(audit.call, own=("drive",), reading=reading, repair=False),
    )


def made_of_robot() -> AuditRecord:
    """An audit of a robot with free arms, without unknowns and with few runs."""
    robot = c2d.robots.absolem(track="public")
    drive = c2d.Drive(speed=0.3, schedule=((0.0, 0.1), (1.0, 0.3)))
    obstacles: dict[str, Terrain] = {"kerb": OBSTACLES["kerb"], "ramp": c2d.terrains.ramp(0.2)}
    ends = {"kerb": {"cleared": 39, "slipping": 1}, "ramp": {"diverged": 40}}
    tables = {
        name: runs_of(name, {OWN: outcomes(ends[name]), BELT: outcomes({})}, np.array([0.3]))
        for name in obstacles
    }
    return AuditRecord(
        robot=robot,
        reading=None,
        lint=lint(robot, None),
        pockets=pockets(robot),
        belt=belt_of(robot),
        obstacles=obstacles,
        vary=Ranges({"start.approach": c2d.shifted(-0.1, 0.1, unit="robot.outline.axle_distance")}),
        unknown={},
        drive=drive,
        call=Call(samples=1, repeats=20, seed=1, repair=False, own=("vary", "drive")),
        verdicts=tuple(verdict_of(table, name) for name, table in tables.items()),
        assumed=(),
        repaired=None,
        table=xr.concat(tables.values(), "terrain").assign_attrs(vary="start", unknown=""),
    )
