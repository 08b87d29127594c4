"""
Barrier, knife edge, gap, stairs
================================

Terrain is an outline in side view, with sharp or rounded edges. Here a robot on a belt drives over
it.
"""

import matplotlib.pyplot as plt

import crawler2d as c2d

grounds = {
    "barrier": c2d.terrains.barrier(0.06, 0.10),
    "knife edge": c2d.terrains.knife_edge(0.06),
    "gap": c2d.terrains.gap(0.20, depth=0.10),
    "ridge": c2d.terrains.ridge(0.06, edge_angle=1.2),
    "half round": c2d.terrains.half_round(0.06),
    "stairs": c2d.terrains.stairs(count=3, rise=0.05, run=0.25),
}
robot = c2d.robots.engineer(flippers=None)
figure, axes = plt.subplots(3, 2, figsize=(10, 8), layout="constrained")
for ax, (name, ground) in zip(axes.flat, grounds.items(), strict=True):
    run = c2d.simulate(robot, ground)
    run.plot(ax, time=run.time[[run.time.size // 2, -1]])
    ax.set_title(f"{name}: {run.outcome}", loc="left")
    ax.get_legend().remove()
handles, labels = axes[0, 0].get_legend_handles_labels()
shown = [label.partition(", up to")[0] for label in labels]  # each picture has its own scale
figure.legend(handles, shown, loc="outside lower center", ncols=3)
