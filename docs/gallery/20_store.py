"""
A sweep that can be interrupted
===============================

With a store every run is kept: the same call goes on where it was, and more repeats cost only what
is new.
"""

import tempfile
from pathlib import Path

import crawler2d as c2d

robot = c2d.robots.engineer(flippers=None)
base = c2d.Scenario(robot, c2d.terrains.step(0.05))
over = {"terrain.height": [0.04, 0.06, 0.08, 0.10]}
floors = {"terrain.friction": c2d.uniform(0.4, 1.0)}
with tempfile.TemporaryDirectory() as folder:
    store = Path(folder, "study.sqlite")
    c2d.sweep(base, over, unknown=floors, repeats=2, store=store, progress=False)
    table = c2d.sweep(base, over, unknown=floors, repeats=4, store=store, progress=False)
    print(c2d.table(store).sizes["run"], "runs in the store")
c2d.rate(table, "cleared").plot()
