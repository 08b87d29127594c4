"""Write a page with a robot that seizes on wheels and clears the same step on a belt.

The page has both replays side by side, the diagnosis, and next steps.
"""

from __future__ import annotations

import argparse
import shlex
from pathlib import Path
from typing import TYPE_CHECKING

from crawler2d.commands.files import OUT, check_place, keeping, show_page
from crawler2d.common.files import write_text
from crawler2d.drawings.svg import escape
from crawler2d.parameters.track import LineOfWheels
from crawler2d.pictures.page import fill_page, read_part
from crawler2d.pictures.page.pair import (
    INTERVAL,
    pair_data,
    pair_figure,
    pair_parts,
    pair_script,
    pair_style,
)
from crawler2d.presets import samples, terrains
from crawler2d.presets.robots import engineer
from crawler2d.runs.batch import simulate

if TYPE_CHECKING:
    from crawler2d.runs.run import Run

__all__ = ["add_arguments", "run"]

_HERE = "crawler2d.commands"
_NAMES = ("on four wheels", "on a belt")
_HEIGHT = 0.075
"""[m] Height of the step."""
_NEXT = (
    ("Does your own model seize, and what would fix it?", "crawler2d audit MODEL.sdf"),
    ("What happens in a scenario of your own?", "crawler2d run SCENARIO.json --html run.html"),
    (
        "The run on wheels, in Python:",
        "import crawler2d as c2d\n"
        "robot = c2d.robots.engineer(flippers=None).without_rotors()\n"
        "wheels = robot.with_track(c2d.LineOfWheels(4, wheel_radius=0.0608))\n"
        'c2d.simulate(wheels, c2d.terrains.step(0.075)).to_html("run.html")',
    ),
)
"""Questions, and commands that answer them."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``crawler2d demo``."""
    parser.add_argument(
        "--out",
        type=Path,
        metavar="PAGE",
        default=OUT / "demo.html",
        help=f"page to write (default: {OUT / 'demo.html'})",
    )
    parser.add_argument("--open", action="store_true", help="open the page in the browser")


def run(options: argparse.Namespace) -> int:
    """Write the page; return the exit status."""
    if options.out.parent == OUT:
        OUT.mkdir(parents=True, exist_ok=True)
    check_place("--out", options.out)
    written: list[Path] = []
    with keeping(written):
        runs = demo_runs()
        written.append(write_text(options.out, demo_page(runs)))
        for name, each in zip(_NAMES, runs, strict=True):
            print(f"{name}: {each.ending}")
        print(f"The page is in {options.out}")
        print(f"Next: crawler2d audit {shlex.quote(str(samples.path()))}")
        print("or a model of your own in its place: SDF, URDF, xacro or MJCF")
        if options.open:
            show_page(options.out)
    return 0


def demo_runs() -> tuple[Run, Run]:
    """Simulate the README's robot at its step: on four touching wheels, and on a belt."""
    robot, step = engineer(flippers=None).without_rotors(), terrains.step(_HEIGHT)
    wheels = robot.with_track(LineOfWheels(4, wheel_radius=0.0608))
    return (
        simulate(wheels, step, sample_interval=INTERVAL),
        simulate(robot, step, sample_interval=INTERVAL),
    )


def demo_page(runs: tuple[Run, Run]) -> str:
    """Write the page of the two runs."""
    wheels, _ = runs
    mass = wheels.scenario.robot.mass
    answer = (
        f"A tracked robot of {mass:.0f} kg at a step of {1e3 * _HEIGHT:.0f} mm. On four wheels in"
        " place of its track it seizes: the edge gets between two of them. On a belt it gets over."
    )
    why, _, tried = wheels.reason.partition(". Tried: ")
    lines = "\n".join(
        f'<li>{escape(question)} <code tabindex="0">{escape(command)}</code></li>'
        for question, command in _NEXT
    )
    return fill_page(
        "demo.html",
        pair_style() + read_part("demo.css", _HERE),
        pair_script(read_part("demo.js", _HERE)),
        _HERE,
        title="crawler2d: a robot that seizes",
        name="One robot, two models of its track",
        answer=escape(answer),
        figures="".join(map(pair_figure, _NAMES, runs)),
        diagnosis=escape(f"{why}."),
        tried=escape(f"{tried}."),
        next=lines,
        data=pair_data(runs, "runs"),
        **pair_parts(),
    )
