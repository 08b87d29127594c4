"""Studies: questions about robots and grounds, each answered by as many runs as it takes.

Every function takes a scenario and models, and returns a `Found`: an xarray data set with a plot of
its own. All take the same keywords of how to simulate:

- `vary`, `unknown`, `samples`, `seed`, `trials`, `store`, `executor`, `threads`, `progress`: as
  `sweep`;
- those that give rates take `until`: when a cell has been simulated often enough, an `Until`; those
  that measure take `repeats`: how often each cell is simulated; `search` takes `first` and
  `confirm`.

Intervals of rates are those of `sequential`, which hold although the number of runs depends on what
they showed. What is measured (`max_speed`, `acceleration`, `braking_distance`, `ride`, `odometry`)
has no interval, but a median over the repeats, and the lowest and the highest of them. The
attribute `settings` counts the cells that were tried.

`real_time_factor` measures the machine, and takes `repeats` and `progress` alone.

>>> import crawler2d as c2d
>>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05))
>>> found = c2d.studies.max_obstacle(base, heights=[0.05, 0.15], progress=False)
>>> found["highest"].values.tolist(), found.attrs["settings"]
([0.05], 2)
"""

from crawler2d.studies.boundary import critical
from crawler2d.studies.decides import what_decides
from crawler2d.studies.driving import acceleration, braking_distance, max_speed
from crawler2d.studies.maps import seizure_map
from crawler2d.studies.obstacles import max_gap, max_obstacle, max_slope, success
from crawler2d.studies.riding import odometry, real_time_factor, ride
from crawler2d.studies.search import search

__all__ = [
    "acceleration",
    "braking_distance",
    "critical",
    "max_gap",
    "max_obstacle",
    "max_slope",
    "max_speed",
    "odometry",
    "real_time_factor",
    "ride",
    "search",
    "seizure_map",
    "success",
    "what_decides",
]
