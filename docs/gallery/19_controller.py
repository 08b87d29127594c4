"""
A controller of your own
========================

A `Simulation` goes on step by step, and takes a new command whenever you like: here one that slows
down as the nose rises.
"""

import matplotlib.pyplot as plt

import crawler2d as c2d

plt.style.use("crawler2d.lines")  # colours that the colour-blind tell apart, and dashes
robot = c2d.robots.engineer(flippers=None)
sim = c2d.Simulation(c2d.Scenario(robot, c2d.terrains.step(0.075)))
while sim.time < 6.0:
    sim.command(speed=0.4 - 0.5 * max(0.0, sim.state().chassis_angle))
    sim.advance(0.02)

# %%
# What it has done becomes a run, with everything that a run has.

run = sim.to_run()
print(run.outcome)
figure, (side, *history) = plt.subplots(4, figsize=(8, 9), layout="constrained")
run.plot(side)
run.plot_history(history)
