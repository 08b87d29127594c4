"""Flippers in pictures: that they are drawn where the contacts of a run say that they are."""

import base64
import dataclasses
import json
import re
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest

import crawler2d as c2d
from conftest import GEAR, PLACEMENTS
from crawler2d import _core
from crawler2d._shapes import carrier_of, carriers, extent, length, mass_center, outlines, placed
from crawler2d.track import Track

mpl.use("Agg")
from matplotlib import pyplot as plt

STEP = c2d.terrains.step(0.2)
LANES = c2d.terrains.lanes(c2d.terrains.step(0.15), c2d.terrains.step(0.12))
CLIMB = c2d.Drive(speed=0.4, gait=c2d.Climb())


def with_flippers(track: Track, arms: Track | None = None, ends: Any = "both") -> c2d.Robot:
    flippers = c2d.Flippers(
        length=0.34,
        root_radius=0.064,
        tip_radius=0.037,
        mass=0.775,
        torque_limit=30.0,
        ends=ends,
        angle=0.8,
        track=arms,
    )
    return dataclasses.replace(c2d.robots.engineer(track=track), flippers=flippers)


ROBOTS: dict[str, c2d.Robot] = {
    "belt": with_flippers(c2d.BeltTrack()),
    "grousers": with_flippers(c2d.GrouserBeltTrack()),
    "gears": with_flippers(c2d.LineOfWheels(5, wheel=c2d.GearWheel(grouser_count=8))),
    "wheels in front": with_flippers(c2d.LineOfWheels(5), ends="front"),
    "wheels on a belt": with_flippers(c2d.GrouserBeltTrack(), c2d.LineOfWheels(4), "rear"),
}


@pytest.fixture(scope="module", params=ROBOTS)
def climb(request: pytest.FixtureRequest) -> c2d.Run:
    return c2d.simulate(ROBOTS[request.param], STEP, drive=CLIMB, duration=4.0)


@pytest.fixture(autouse=True)
def _close() -> Any:
    yield
    plt.close("all")


def geometry_of(run: c2d.Run) -> Any:
    return _core.geometry(run.scenario.to_json())


def distance(point: Any, outline: Any) -> float:
    """[m] Of a point from a closed line."""
    a, way = outline[:-1], np.diff(outline, axis=0)
    share = (((point - a) * way).sum(axis=1) / (way * way).sum(axis=1)).clip(0.0, 1.0)
    return float(np.linalg.norm(a + share[:, None] * way - point, axis=1).min())
