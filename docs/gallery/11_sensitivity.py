"""
Which parameters matter most?
=============================

Nobody knows exactly where the centre of mass is, how strong the motors are, or what the floor is
like. Sobol indices say how much of the outcome depends on each, so what to measure first.
"""

import crawler2d as c2d

robot = c2d.robots.engineer(flippers=None)
found = c2d.studies.sensitivity(
    c2d.Scenario(robot, c2d.terrains.step(0.08)),
    unknown=c2d.unknowns.of_robot(robot) | c2d.unknowns.of_ground(),
    samples=64,
    until=c2d.Until(threshold=0.5, min_runs=5, max_runs=20),
    progress=False,
)
found.plot()
