"""Simulate tracked robots in side view, with any model of their tracks.

A track is a belt, a set of wheels, a chain of shoes or just a force. Units are SI, angles are in
radians, x points forward, y up.

`simulate` drives a robot, from `robots` or `read_robot`, over one of the `terrains`. `sweep`,
`rate`, `compare` and `studies` find how often it gets over. `audit` finds where a model file
seizes: stops with an edge between two wheels that model a track.

>>> import crawler2d as c2d
>>> robot = c2d.robots.engineer(flippers=None).with_track(c2d.BeltTrack())
>>> run = c2d.simulate(robot, c2d.terrains.step(0.05))
>>> str(run.outcome)
'cleared'
"""

import sys

from crawler2d.common import ctrl_c

# The imports below take a moment, in which Ctrl-C must already work.
if ctrl_c.is_command(sys.argv, sys.orig_argv):
    ctrl_c.end_in_one_line()

# isort: split

from importlib import import_module
from typing import TYPE_CHECKING

from crawler2d.common.bodies import BodyKind, Lane
from crawler2d.common.build import build_info
from crawler2d.common.keywords import limits_hint
from crawler2d.errors import (
    Crawler2dError,
    LimitError,
    RunUnfinished,
    ScenarioError,
    ScenarioWarning,
    SimulationDiverged,
    StoreError,
)
from crawler2d.parameters.drivetrain import PI, Drivetrain
from crawler2d.parameters.flippers import Flippers
from crawler2d.parameters.outline import TrackOutline
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Climb, Drive, Hold, SeizureCriteria, Solver, Start
from crawler2d.parameters.track import (
    BeltTrack,
    CircumferentialWheels,
    ClosedTrack,
    ForceTrack,
    GearWheel,
    GrouserBeltTrack,
    HybridWheels,
    LineOfWheels,
    RoundWheel,
    SegmentalTrack,
)
from crawler2d.presets import robots, samples, terrains, unknowns
from crawler2d.results.diagnosis import Diagnosis
from crawler2d.results.findings import Mechanism
from crawler2d.results.outcome import Outcome
from crawler2d.runs.batch import BatchInterrupted, simulate, simulate_many
from crawler2d.runs.explore import explore
from crawler2d.runs.film import animate
from crawler2d.runs.run import Run
from crawler2d.runs.simulation import Simulation
from crawler2d.runs.simulations import Simulations
from crawler2d.variation import variability
from crawler2d.variation.distributions import scaled, shifted, uniform, uniform_int

if TYPE_CHECKING:
    from crawler2d import envs as envs  # not in __all__, see _LAZY
    from crawler2d import studies
    from crawler2d.audits.audit import Audit, audit
    from crawler2d.reading.reading import Reading, read_robot
    from crawler2d.runs.jams import jams
    from crawler2d.runs.saved import load
    from crawler2d.sweeps.rates import rate
    from crawler2d.sweeps.sequential import Until, sequential
    from crawler2d.sweeps.statistics import newcombe, newcombe_paired, wilson
    from crawler2d.sweeps.store import check_store, join_stores
    from crawler2d.sweeps.sweep import compare, sweep
    from crawler2d.sweeps.tabulate import table

__all__ = [
    "PI",
    "Audit",
    "BatchInterrupted",
    "BeltTrack",
    "BodyKind",
    "CircumferentialWheels",
    "Climb",
    "ClosedTrack",
    "Crawler2dError",
    "Diagnosis",
    "Drive",
    "Drivetrain",
    "Flippers",
    "ForceTrack",
    "GearWheel",
    "GrouserBeltTrack",
    "Hold",
    "HybridWheels",
    "Lane",
    "LimitError",
    "LineOfWheels",
    "Mechanism",
    "Outcome",
    "Reading",
    "Robot",
    "RoundWheel",
    "Run",
    "RunUnfinished",
    "Scenario",
    "ScenarioError",
    "ScenarioWarning",
    "SegmentalTrack",
    "SeizureCriteria",
    "Simulation",
    "SimulationDiverged",
    "Simulations",
    "Solver",
    "Start",
    "StoreError",
    "TrackOutline",
    "Until",
    "animate",
    "audit",
    "build_info",
    "check_store",
    "compare",
    "explore",
    "jams",
    "join_stores",
    "load",
    "newcombe",
    "newcombe_paired",
    "rate",
    "read_robot",
    "robots",
    "samples",
    "scaled",
    "sequential",
    "shifted",
    "simulate",
    "simulate_many",
    "studies",
    "sweep",
    "table",
    "terrains",
    "uniform",
    "uniform_int",
    "unknowns",
    "variability",
    "wilson",
]

__version__ = str(build_info()["version"])

# Imported on first use: they take as long as the rest, and not every user needs them.
_LAZY = {
    "Audit": "crawler2d.audits.audit",
    "audit": "crawler2d.audits.audit",
    "Reading": "crawler2d.reading.reading",
    "read_robot": "crawler2d.reading.reading",
    "studies": "crawler2d.studies",
    "jams": "crawler2d.runs.jams",
    "Until": "crawler2d.sweeps.sequential",
    "check_store": "crawler2d.sweeps.store",
    "compare": "crawler2d.sweeps.sweep",
    "envs": "crawler2d.envs",  # not in `__all__`: it needs gymnasium
    "join_stores": "crawler2d.sweeps.store",
    "load": "crawler2d.runs.saved",
    "newcombe": "crawler2d.sweeps.statistics",
    "newcombe_paired": "crawler2d.sweeps.statistics",
    "rate": "crawler2d.sweeps.rates",
    "sequential": "crawler2d.sweeps.sequential",
    "sweep": "crawler2d.sweeps.sweep",
    "table": "crawler2d.sweeps.tabulate",
    "wilson": "crawler2d.sweeps.statistics",
}


if not TYPE_CHECKING:  # mypy would accept any name

    def __getattr__(name: str) -> object:
        """Import a name on first use."""
        if name not in _LAZY:
            raise AttributeError(
                f"module {__name__!r} has no attribute {name!r}{limits_hint(name)}"
            )
        module = import_module(_LAZY[name])
        value = module if module.__name__ == f"{__name__}.{name}" else getattr(module, name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    """List all public names, including those not yet imported, for completion."""
    own = (name for name in globals() if name.startswith("__"))
    return sorted({*own, *__all__, *_LAZY, "errors"})


if build_info()["profile"] == "debug":
    import warnings

    warnings.warn(
        "crawler2d was built without optimisation and is slow", RuntimeWarning, stacklevel=2
    )
