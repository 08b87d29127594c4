"""
Gear wheels, and why they are turned against each other
=======================================================

A gear wheel stands on one grouser, then on two, and its axle goes up and down. If all wheels stand
alike, so does the robot; eq. (1) of the paper turns each by a third of the angle between two
grousers more than the one before.
"""

import matplotlib.pyplot as plt

import crawler2d as c2d

plt.style.use("crawler2d.lines")  # colours that the colour-blind tell apart, and dashes
robot = c2d.robots.engineer(flippers=None)
figure, ax = plt.subplots(figsize=(8, 4), layout="constrained")
for name, fraction in {"in step": 0.0, "a third": 1 / 3, "a half": 1 / 2}.items():
    wheel = c2d.GearWheel(grouser_count=12, phase_fraction=fraction)
    geared = robot.with_track(c2d.LineOfWheels(5, wheel=wheel))
    run = c2d.simulate(geared, c2d.terrains.flat(length=1.0))
    late = run.time > 1.0
    ax.plot(
        run.time[late], 1000 * (run.position[late, 1] - run.position[late, 1].max()), label=name
    )
ax.set(xlabel="time [s]", ylabel="height [mm]", xlim=(1.0, 2.0))
ax.set_title("Height of a robot on five gear wheels, below its highest", loc="left")
figure.legend(loc="outside lower center", ncols=3)
