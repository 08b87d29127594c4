"""
First climb
===========

A robot, a terrain, a run. The robot is the Servosila Engineer without its flippers, the terrain a
step of 75 mm, the track a moving belt.
"""

import crawler2d as c2d

robot = c2d.robots.engineer(flippers=None)
run = c2d.simulate(robot, c2d.terrains.step(0.075))
run.plot()

# %%
# As the last value of a cell of a notebook a run shows itself as a replay: press play, or drag the
# time.

run
