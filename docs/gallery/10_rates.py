"""
Rates with intervals
====================

A single run can be luck. `sweep` simulates each combination many times, here from varied starts on
six floors of uncertain friction, and `rate` says how often a run clears: a rate with an interval on
each floor, and a band over the floors.
"""

import crawler2d as c2d

robot = c2d.robots.engineer(flippers=None).without_rotors()
models = {
    "belt": c2d.BeltTrack(),
    "4 round wheels": c2d.LineOfWheels(4, wheel_radius=0.0608),
    "4 gear wheels": c2d.LineOfWheels(4, wheel_radius=0.0608, wheel=c2d.GearWheel()),
}
table = c2d.sweep(
    c2d.Scenario(robot, c2d.terrains.step(0.05)),
    {"robot.track": models, "terrain.height": [0.03, 0.05, 0.07]},
    repeats=5,
    unknown={"terrain.friction": c2d.uniform(0.6, 1.0)},
    samples=6,
    progress=False,
)
c2d.rate(table, "cleared").plot()
