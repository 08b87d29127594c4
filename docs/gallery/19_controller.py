"""
A controller of your own
========================

A `Simulation` goes on step by step, and takes a new command whenever you like: here one that slows
down as the nose rises.
"""

import matplotlib.pyplot as plt

import crawler2d as c2d

robot = c2d.robots.engineer(flippers=None)
sim = c2d.Simulation(c2d.Scenario(robot, c2d.terrains.step(0.075)))
states = [sim.state()]
while sim.time < 6.0:
    sim.command(speed=0.4 - 0.5 * max(0.0, states[-1].chassis_angle))
    sim.advance(0.02)
    states.append(sim.state())
print(states[-1].outcome)

figure, ax = plt.subplots(figsize=(8, 4), layout="constrained")
times = [state.time for state in states]
ax.plot(times, [state.chassis_angle for state in states], label="chassis angle [rad]")
ax.plot(times, [state.track_speed for state in states], label="track speed [m/s]")
ax.set_xlabel("time [s]")
ax.set_title("Slower while the nose rises", loc="left")
ax.legend()
