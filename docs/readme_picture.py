"""Draws docs/readme.png, the example of README.md in side view; `make picture` runs it."""

from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

import crawler2d as c2d

PICTURE = Path(__file__).with_name("readme.png")


def draw() -> Figure:
    """Draw the robot of the example on wheels and on a belt, side by side and to one scale."""
    robot = c2d.robots.engineer(flippers=None).without_rotors()
    obstacle = c2d.terrains.step(0.075)
    wheels = robot.with_track(c2d.LineOfWheels(4, wheel_radius=0.0608))
    figure = Figure(figsize=(10.0, 3.7), layout="constrained")
    on_wheels, on_belt = figure.subplots(1, 2, sharey=True, width_ratios=[0.8, 1.2])

    run = c2d.simulate(wheels, obstacle)
    run.plot(on_wheels, time=run.time[-1], trials=False)
    on_wheels.set_title(f"on wheels: {run.outcome}", loc="left")
    on_wheels.set_xlim(-0.35, 0.45)

    run = c2d.simulate(robot, obstacle)
    run.plot(on_belt, time=[1.6, 2.3, run.time[-1]])
    on_belt.set_title(f"on a belt: {run.outcome}", loc="left")
    on_belt.set(xlim=(-0.45, 0.75), ylim=(-0.05, 0.40), ylabel="")

    for axes in (on_wheels, on_belt):
        axes.get_legend().remove()
    handles, labels = on_wheels.get_legend_handles_labels()
    shown = [label.partition(", up to")[0] for label in labels]  # each picture has its own scale
    options: Any = {"ncols": 3, "fontsize": "small", "frameon": False}
    figure.legend(handles, shown, loc="outside lower center", **options)
    return figure


if __name__ == "__main__":
    mpl.use("Agg")
    draw().savefig(PICTURE, dpi=120)
