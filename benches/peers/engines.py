"""All engines, in the order of the tables."""

from __future__ import annotations

import sys
from dataclasses import replace
from functools import cache
from importlib import import_module

from benches.peers.engine import Engine, Setting

_CLASSES = {
    "pymunk": "engine_pymunk:Pymunk",
    "Box2D v3": "engine_box2d:Box2D",
    "MuJoCo": "engine_mujoco:MuJoCo",
    "rapier2d": "engine_rapier:Rapier",
    "crawler2d": "engine_crawler2d:Crawler2D",
}
NAMES = tuple(_CLASSES)


@cache
def engine(name: str) -> Engine:
    """Import an engine, once per process."""
    module, kind = _CLASSES[name].split(":")
    try:
        made: Engine = getattr(import_module(f"benches.peers.{module}"), kind)()
    except ModuleNotFoundError as error:
        sys.exit(f"{name} needs {error.name}: pip install --group peers")
    return made


def engines() -> list[Engine]:
    """Import all engines."""
    return [engine(name) for name in NAMES]


def at(engine: Engine, time_step: float, *, tuned: bool = False) -> Setting:
    """Return an engine's defaults with another time step [s]; crawler2d keeps its accuracy."""
    if engine.defaults.accuracy:
        return engine.defaults
    return replace(engine.defaults, time_step=time_step, tuned=tuned)
