"""Studies of robots on terrains, each with as many runs as its answer needs.

Every function takes a scenario and models, and returns a `FigureDataset`: an xarray data set whose
`plot` draws its figure. Common keywords:

- `vary`, `unknown`, `samples`, `seed`, `trials`, `store`, `executor`, `threads`, `progress`: see
  `sweep`;
- studies of rates take `until`, an `Until` that ends the runs of a cell; studies of measures take
  `repeats`, the runs per cell; `search` takes `first` and `confirm`.

Intervals of rates are those of `sequential`, which are valid although the number of runs depends on
the results. Measures (`max_speed`, `acceleration`, `braking_distance`, `ride`, `odometry`) have a
median, minimum and maximum over the repeats instead of an interval. The attribute `settings` is the
number of cells tried.

`real_time_factor` measures the machine, and takes only `repeats` and `progress`. `jam_chart` and
`certify` compute without runs, and take none of these; `certify` returns a `Certificate`.

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
