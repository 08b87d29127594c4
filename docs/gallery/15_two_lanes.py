"""
Each track on its own ground
============================

A barrier turned about the vertical axis by 20 degrees: the left track meets it before the right
one. The body is kept level from side to side, so that the first track carries it up.
"""

import math

import crawler2d as c2d

robot = c2d.robots.engineer(flippers=None)
ground = c2d.terrains.diagonal_barrier(math.radians(20.0), height=0.06)
run = c2d.simulate(robot, ground)
run.plot()

# %%
# What bore on which lane, halfway:

contacts = run.contacts.to_pandas()
middle = contacts[contacts.time == contacts.time.iloc[len(contacts) // 2]]
middle[["lane", "body", "x", "y", "normal_force"]].round(3)
