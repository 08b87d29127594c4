"""
First climb
===========

A robot, a terrain, a run. The robot is the Servosila Engineer without its flippers, the terrain a step of 75 mm, the
track a moving belt. In a notebook, and here, a run shows itself as a replay: press play, or drag the time slider.
"""

import crawler2d as c2d

robot = c2d.robots.engineer(flippers=None)
run = c2d.simulate(robot, c2d.terrains.step(0.075))
run
