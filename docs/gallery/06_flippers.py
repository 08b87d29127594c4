"""
Climbing with flippers
======================

The gait `Climb` raises the front flippers, swings them down onto the obstacle and lifts the chassis
with the rear ones. The Absolem gets over a wall of 20 cm that its tracks alone do not climb.
"""

import crawler2d as c2d

absolem = c2d.robots.absolem()
wall = c2d.terrains.step(0.20)
print(c2d.simulate(absolem.without_flippers(), wall).outcome)
run = c2d.simulate(absolem, wall, drive=c2d.Drive(gait=c2d.Climb()))
run.plot()

# %%
# The replay:

run
