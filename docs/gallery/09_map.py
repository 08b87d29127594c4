"""
A map over height and friction
==============================

Each cell is simulated until it is certain how most runs end; where the outcome changes from cell to
cell, the grid is refined.
"""

import crawler2d as c2d

robot = c2d.robots.engineer(flippers=None).without_rotors()
wheels = robot.with_track(c2d.LineOfWheels(4, wheel_radius=0.0608))
found = c2d.studies.seizure_map(
    c2d.Scenario(wheels, c2d.terrains.step(0.05)),
    ("terrain.height", [0.03, 0.05, 0.07, 0.09]),
    ("terrain.friction", [0.5, 0.7, 0.9]),
    progress=False,
)
found.plot()
