"""
Grousers
========

A belt with grousers hooks onto an edge on which a smooth belt slips: here on slippery ground.
"""

import matplotlib.pyplot as plt

import crawler2d as c2d

robot = c2d.robots.engineer(flippers=None)
step = c2d.terrains.step(0.07, friction=0.3)
figure, axes = plt.subplots(2, figsize=(8, 6), layout="constrained", sharex=True)
for ax, track in zip(axes, (c2d.BeltTrack(), c2d.GrouserBeltTrack()), strict=True):
    run = c2d.simulate(robot.with_track(track), step)
    run.plot(ax, time=[0.0, run.time[-1]], trials=False)
    ax.set_xlim(-0.9, 0.9)
    ax.label_outer()
    ax.get_legend().remove()
handles, labels = axes[0].get_legend_handles_labels()
shown = [label.partition(", up to")[0] for label in labels]  # each picture has its own scale
figure.legend(handles, shown, loc="outside lower center", ncols=4)
