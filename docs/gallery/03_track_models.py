"""
Every track model on one step
=============================

One robot, one step of 75 mm, and each model of its track. Mass, centre of mass and moment of
inertia are the same.
"""

import matplotlib.pyplot as plt

import crawler2d as c2d

models = (
    c2d.BeltTrack(),
    c2d.GrouserBeltTrack(),
    c2d.SegmentalTrack(),
    c2d.LineOfWheels(4, wheel_radius=0.0608),
    c2d.LineOfWheels(5),
    c2d.CircumferentialWheels(24),
    c2d.HybridWheels([(-0.18, 0.0, 0.064), (0.0, -0.03, 0.034), (0.18, 0.0, 0.064)]),
    c2d.ForceTrack(),
)
robot = c2d.robots.engineer(flippers=None).without_rotors()
figure, axes = plt.subplots(4, 2, figsize=(10, 9.5), layout="constrained", sharex=True, sharey=True)
for ax, track in zip(axes.flat, models, strict=True):
    run = c2d.simulate(robot.with_track(track), c2d.terrains.step(0.075))
    run.plot(ax, time=run.time[-1], trials=False)
    ax.set_xlim(-0.6, 0.8)
    ax.set_title(f"{track.description}: {run.outcome}", loc="left")
    ax.label_outer()
    ax.get_legend().remove()
shown = {
    label.partition(", up to")[0]: handle  # in each picture to a scale of its own
    for ax in axes.flat
    for handle, label in zip(*ax.get_legend_handles_labels(), strict=True)
}
figure.legend(shown.values(), shown, loc="outside lower center", ncols=2)
