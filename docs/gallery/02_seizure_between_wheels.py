"""
Seizure between wheels
======================

The same step, the same robot, on four wheels that touch: the edge gets between two of them, and it
stops.
"""

import crawler2d as c2d

robot = c2d.robots.engineer(flippers=None).without_rotors()
wheels = robot.with_track(c2d.LineOfWheels(4, wheel_radius=0.0608))
run = c2d.simulate(wheels, c2d.terrains.step(0.075))
print(run.diagnosis)
run.plot(time=run.time[-1])

# %%
# The buttons below the replay show where the robot ended when one thing was changed at the stop.

run
