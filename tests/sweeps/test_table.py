"""Runs of a batch as a table."""

from pathlib import Path

import pandas as pd
import pytest
import xarray as xr

import crawler2d as c2d
from tests.kept import refusing
from tests.sweeps.small import BASE, BRIEF, MODELS, SAID, interrupt_after, quiet


def test_the_table_of_a_batch_has_the_columns_of_a_sweep() -> None:
    base = BASE.replace({"robot.track": c2d.ForceTrack(), "duration": 8.0})
    scenarios = [base.replace({"terrain.height": height}) for height in (0.01, 0.12)]
    runs = c2d.simulate_many(scenarios, record="summary", trials=("torque x 2",))
    found = c2d.table(runs)
    swept = quiet(
        base, {"terrain.height": [0.01, 0.12]}, repeats=1, vary={}, trials=("torque x 2",)
    )
    for name in swept.data_vars:
        if name not in ("seed", "scenario"):
            assert found[name].values.tolist() == pytest.approx(
                swept[name].values[:, 0].tolist(), nan_ok=True
            ), name
    assert found["scenario"].values.tolist() == [scenario.to_json() for scenario in scenarios]
    assert (found["wall_time"] > 0.0).all()


def test_runs_without_a_result_are_rows_too() -> None:
    broken = BRIEF.replace({"robot.mass": -1.0})
    runs = c2d.simulate_many([BRIEF, broken], on_error="record")
    found = c2d.table(runs)
    assert found["outcome"].values.tolist() == ["timed_out", "refused"]
    assert "robot.mass must be" in found["error"].values[1]
    assert c2d.rate(found, "timed_out", dim="run")["count"].item() == 1


def test_an_interrupted_batch_is_a_table_of_what_was_finished() -> None:
    progress = interrupt_after(2)
    with pytest.raises(c2d.BatchInterrupted) as caught:
        c2d.simulate_many([BASE] * 2000, progress=progress, threads=1, record="summary")
    found = c2d.table(caught.value.runs)
    finished = (found["outcome"] == "cleared").sum().item()
    assert 3 <= finished < 2000
    assert (found["outcome"] == "failed").sum().item() == 2000 - finished


def test_no_runs_give_an_empty_table_and_anything_but_a_run_is_refused() -> None:
    assert c2d.table([]).sizes == {"run": 0}
    with refusing(SAID, r"runs\[0\] must be a Run"):
        c2d.table([BASE])  # type: ignore[list-item]
    with refusing(SAID, r"^runs must be several: give|^runs must be several, got"):
        c2d.table(3)  # type: ignore[arg-type]


def test_tables_and_rates_go_to_netcdf_and_back_and_to_parquet(tmp_path: Path) -> None:
    unknown = {"terrain.friction": c2d.uniform(0.5, 1.0)}
    found = quiet(BASE, {"robot.track": MODELS}, unknown=unknown, samples=2, trials="auto")
    for name, dataset in {"runs": found, "rates": c2d.rate(found)}.items():
        dataset.to_netcdf(tmp_path / f"{name}.nc")
        back = xr.load_dataset(tmp_path / f"{name}.nc")
        assert back.identical(dataset)
    found.to_dataframe().to_parquet(tmp_path / "runs.parquet")
    frame = pd.read_parquet(tmp_path / "runs.parquet")
    assert frame["scenario"].tolist() == found["scenario"].values.ravel().tolist()
    assert frame["final_x"].tolist() == found["final_x"].values.ravel().tolist()
