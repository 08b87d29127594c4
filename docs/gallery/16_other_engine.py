"""
Is it mechanics, or this solver?
================================

`cross_check` simulates the same scenario with the dynamics of rapier, a game engine, and compares.
Statics tells whether each stop is an equilibrium.
"""

import crawler2d as c2d

robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4)).without_rotors()
run = c2d.simulate(robot, c2d.terrains.step(0.10))
check = run.cross_check(announce=False)
print(check)
check.plot()
