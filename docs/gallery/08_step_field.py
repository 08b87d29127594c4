"""
Over a random step field
========================

Rows of posts of random heights, one post under each track: the left track (lane 1) and the right
one (lane 2) meet different ground, and still carry one body.
"""

import crawler2d as c2d

robot = c2d.robots.engineer(flippers=None, track=c2d.GrouserBeltTrack())
run = c2d.simulate(robot, c2d.terrains.random_stepfield(2))
run.plot()

# %%
# The replay:

run
