"""Structure and draws of tables of sweeps, rates and comparisons are as in `kept`.

Figures of runs are left out, as results move with the physics.
"""

from collections.abc import Callable
from pathlib import Path

import pytest
import xarray as xr

import crawler2d as c2d
from crawler2d.common.units import METRICS
from crawler2d.sweeps.axes import COLUMNS
from tests.kept import check_kept
from tests.sweeps.small import BASE, BRIEF, MODELS, quiet

OF_DRAWS = ("drawn_", "unknown_")
KEPT = Path(__file__).parent / "kept"

DRAWN = {
    "start.approach": c2d.shifted(-0.1, 0.1),
    "terrain.friction": c2d.scaled(0.9, 1.1),
    "robot.belly[*][1]": c2d.shifted(-0.01, 0.0),
}
UNKNOWN = {
    "robot.mass": c2d.uniform(8.0, 12.0),
    "robot.center_of_mass[0]": c2d.shifted(-0.02, 0.02),
}


def described(dataset: xr.Dataset) -> str:
    """Describe dimensions, attributes, columns except metrics, and draws.

    The kind of a column is that of NumPy, such as u for whole numbers without a sign.
    """
    lines = [f"dimensions: {dict(dataset.sizes)}"]
    lines += [
        f"{name} = {value}"
        for name, value in dataset.attrs.items()
        if name != "scenario" and not str(name).startswith("build_")
    ]
    for name, each in dataset.variables.items():
        if name in METRICS:
            continue
        attributes = ", ".join(f"{key} {value!r}" for key, value in each.attrs.items())
        lines.append(
            f"{name} ({each.dtype.kind}) over {', '.join(map(str, each.dims))}: {attributes}"
        )
        if name in dataset.coords or str(name).startswith((*OF_DRAWS, "seed")):
            values = [f"{value:.9g}" for value in each.values.ravel() if each.dtype.kind == "f"]
            lines.append(f"  {', '.join(values or map(str, each.values.ravel()))}")
    return "".join(f"{line}\n" for line in lines)


def of_unknowns() -> xr.Dataset:
    base = BRIEF.replace({"robot.belly": [(-0.1, 0.0), (0.1, 0.0), (0.0, 0.05)]})
    over = {
        "terrain.height": [0.02, 0.03],
        ("drive.speed", "robot.track"): {
            "slow": (0.1, c2d.BeltTrack()),
            "fast": (0.2, c2d.ForceTrack()),
        },
    }
    how = {"samples": 2, "seed": 2**63 - 1, "wall_time": True, "trials": "all"}
    return quiet(base, over, vary=DRAWN, unknown=UNKNOWN, **how)


TABLES: dict[str, Callable[[], xr.Dataset]] = {
    "sweep": lambda: quiet(BRIEF, {"robot.track": MODELS}, repeats=3, seed=2**63),
    "unknowns": of_unknowns,
    "compare": lambda: c2d.compare(BASE, MODELS, repeats=2, reference="line of 3", progress=False),
    "runs": lambda: c2d.table(c2d.simulate_many([BRIEF], trials=("torque x 2",))),
    "rate": lambda: c2d.rate(quiet(BRIEF, {"robot.track": MODELS}, vary={}), "timed_out"),
    "band": lambda: c2d.rate(of_unknowns(), "stopped", confidence_level=0.9),
}


@pytest.mark.parametrize("name", TABLES)
def test_a_table_is_made_of_these_columns(name: str) -> None:
    check_kept(KEPT / f"{name}.txt", described(TABLES[name]()))


@pytest.mark.parametrize("name", ["unknowns", "band"])
def test_an_axis_takes_the_name_of_no_column(name: str) -> None:
    table = TABLES[name]()
    columns = {each for each in map(str, table.data_vars) if not each.startswith(OF_DRAWS)}
    assert columns <= {*COLUMNS, *METRICS}
