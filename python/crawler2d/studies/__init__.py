"""Studies: questions about robots and grounds, each answered by as many runs as it takes.

Every function takes a scenario and models, and returns a `Found`: an xarray data set with a plot of
its own. All take the same keywords of how to simulate:

- `until`: when a cell has been simulated often enough, an `Until`;
- `vary`, `unknown`, `samples`, `seed`, `trials`, `store`, `executor`, `threads`, `progress`: as
  `sweep`.

Intervals are those of `sequential`, which hold although the number of runs depends on what they
showed. The attribute `settings` counts the cells that were tried.

>>> import crawler2d as c2d
>>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05))
>>> found = c2d.studies.max_obstacle(base, heights=[0.05, 0.15], progress=False)
>>> found["highest"].values.tolist(), found.attrs["settings"]
([0.05], 2)
"""

from crawler2d.studies.boundary import critical
from crawler2d.studies.crossing import success
from crawler2d.studies.obstacles import max_gap, max_obstacle, max_slope

__all__ = ["critical", "max_gap", "max_obstacle", "max_slope", "success"]
