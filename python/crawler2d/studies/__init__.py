"""Studies of robots and grounds, each with as many runs as its answer needs.

Every function takes a scenario and models, and returns a `FigureDataset`: an xarray data set whose
`plot` draws its figure. All take the same keywords:

- `vary`, `unknown`, `samples`, `seed`, `trials`, `store`, `executor`, `threads`, `progress`: as
  `sweep`;
- studies of rates take `until`, an `Until`: when a cell has been simulated often enough; those that
  measure take `repeats`, the runs of each cell; `search` takes `first` and `confirm`.

Intervals of rates are those of `sequential`, which hold although the number of runs depends on
their results. Measures (`max_speed`, `acceleration`, `braking_distance`, `ride`, `odometry`) have
no interval, but a median over the repeats, and the lowest and the highest of them. The attribute
`settings` counts the cells that were tried.

`real_time_factor` measures the machine, and takes only `repeats` and `progress`. `jam_chart`
and `certify` simulate nothing, and take none of them; `certify` returns a `Certificate`.

>>> import crawler2d as c2d
>>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05))
>>> found = c2d.studies.max_obstacle(base, heights=[0.05, 0.15], progress=False)
>>> found["highest"].values.tolist(), found.attrs["settings"]
([0.05], 2)
"""

from crawler2d.studies.boundary import critical_value
from crawler2d.studies.certificates import certify
from crawler2d.studies.driving import acceleration, braking_distance, max_speed
from crawler2d.studies.jams import jam_chart
from crawler2d.studies.maps import seizure_map
from crawler2d.studies.obstacles import max_gap, max_obstacle, max_slope, success_rate
from crawler2d.studies.riding import odometry, real_time_factor, ride
from crawler2d.studies.search import search
from crawler2d.studies.sensitivity import sensitivity

__all__ = [
    "acceleration",
    "braking_distance",
    "certify",
    "critical_value",
    "jam_chart",
    "max_gap",
    "max_obstacle",
    "max_slope",
    "max_speed",
    "odometry",
    "real_time_factor",
    "ride",
    "search",
    "seizure_map",
    "sensitivity",
    "success_rate",
]


def __dir__() -> list[str]:
    """List what is public, for completion."""
    return sorted(__all__)
