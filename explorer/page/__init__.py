"""Writes the explorer: one page with the core, the initial scenario and the texts."""

from __future__ import annotations

import base64
import gzip
import json
from typing import Any

import crawler2d as c2d
from crawler2d.parameters.fields import Parameters
from crawler2d.parameters.track import Track
from crawler2d.pictures.page import as_json, fill_page, read_part, scene_script
from crawler2d.results.diagnosis import vocabulary
from crawler2d.results.outcome import MECHANISMS, OUTCOMES
from crawler2d.runs.branch import trial_names

_HERE = "explorer.page"

_SCRIPTS = ("words.js", "state.js", "fields.js", "core.js", "handles.js", "explorer.js")

_CODE = """\
import crawler2d as c2d

robot = c2d.robots.engineer(flippers=None).without_rotors()
wheels = robot.with_track(c2d.LineOfWheels(4, wheel_radius=0.0608))
scenario = c2d.Scenario(wheels, c2d.terrains.step(0.075))
"""
"""The initial scenario: that of the README."""

_TRACKS: tuple[Track, ...] = (
    c2d.LineOfWheels(4, wheel_radius=0.0608),
    c2d.CircumferentialWheels(24, wheel_radius=0.015),
    c2d.GrouserBeltTrack(),
    c2d.SegmentalTrack(),
)
_GROUNDS = (
    c2d.terrains.step(0.075),
    c2d.terrains.barrier(0.06, 0.08),
    c2d.terrains.ridge(0.06, 1.57),
    c2d.terrains.half_round(0.06),
    c2d.terrains.gap(0.15, depth=0.1),
    c2d.terrains.stairs(rise=0.06),
)
_WHEELS = (c2d.RoundWheel(), c2d.GearWheel())
_BELT = c2d.BeltTrack()


def begin() -> c2d.Scenario:
    """Make the initial scenario of the page."""
    names: dict[str, Any] = {}
    exec(_CODE, names)  # the lines that the page offers to copy
    scenario = names["scenario"]
    assert isinstance(scenario, c2d.Scenario)
    return scenario


def explorer_page(core: bytes, script: str = "") -> str:
    """Write the page.

    Parameters
    ----------
    core : bytes
        The core as WebAssembly.
    script : str
        Additional script.

    Returns
    -------
    str
        HTML.
    """
    parts = (read_part(name, _HERE) for name in _SCRIPTS)
    style = read_part("replay.css") + read_part("explorer.css", _HERE)
    return fill_page(
        "explorer.html",
        style,
        scene_script(*parts, script),
        _HERE,
        # The page compiles the core, and runs it in a worker whose source is in the page.
        script_sources="'wasm-unsafe-eval'; worker-src blob:",
        title="crawler2d explorer",
        tables=as_json(tables()),
        worker=read_part("worker.js", _HERE),
        core=base64.b64encode(gzip.compress(core, mtime=0)).decode("ascii"),
    )


def tables() -> dict[str, Any]:
    """Collect the data of the package that the scripts need: scenarios as JSON, names and texts."""
    scenario = begin()
    written = json.loads(scenario.to_json())

    def kinds(path: str, choices: tuple[Parameters, ...]) -> dict[str, Any]:
        """Write a part of the scenario for each choice."""
        texts = (scenario.replace({path: choice}).to_json() for choice in choices)
        values = (_part(json.loads(text), path) for text in texts)
        return {value["kind"]: value for value in values}

    wheels = kinds("robot.track.wheel", _WHEELS)
    tracks, grounds = kinds("robot.track", _TRACKS), kinds("terrain", _GROUNDS)
    names = zip({**tracks, **grounds, **wheels}, (*_TRACKS, *_GROUNDS, *_WHEELS), strict=True)
    patterns = {kind: _pattern(each) for kind, each in zip(tracks, _TRACKS, strict=True)}
    return {
        "begin": written,
        "kinds": {"robot.track": tracks, "terrain": grounds, "robot.track.wheel": wheels},
        "belt": kinds("robot.track", (_BELT,))["belt"],
        "code": _CODE,
        "classes": {kind: _function(each) for kind, each in names},
        "trials": trial_names("auto"),
        "words": {
            **vocabulary(),
            "outcomes": OUTCOMES,
            "mechanisms": MECHANISMS,
            "tracks": {**patterns, "belt": _BELT.description},
        },
    }


def _part(values: Any, path: str) -> Any:
    for name in path.split("."):
        values = values[name]
    return values


def _function(each: Parameters) -> str:
    """Return the name of the function of `crawler2d` that makes a track, a wheel or a ground."""
    name = type(each).__name__
    if hasattr(c2d, name):
        return name
    return next(
        f"terrains.{short}"
        for short in c2d.terrains.__all__
        if getattr(c2d.terrains, short) is type(each)
    )


def _pattern(track: Track) -> str:
    """Describe a track, with the paths of its fields instead of their values."""
    text = track.description
    if isinstance(track, c2d.LineOfWheels | c2d.CircumferentialWheels):
        for value, path in ((str(track.count), "{count}"), (track.wheel.kind, "{wheel.kind}")):
            text = text.replace(value, path, 1)  # "24 round wheels all round"
    return text
