"""
What would free it?
===================

Each trial changes one thing in the pose of the stop and lets the robot drive on.
"""

import crawler2d as c2d

robot = c2d.robots.engineer(flippers=None).without_rotors()
wheels = robot.with_track(c2d.LineOfWheels(4, wheel_radius=0.0608))
run = c2d.simulate(wheels, c2d.terrains.step(0.075))
for trial in run.trials():
    print(f"{trial.name:36}{'freed' if trial.freed else 'not freed'}")

# %%
# Where the trials that freed it ended:

run.plot(time=run.time[-1])
