"""Tables as Arrow, for polars, DuckDB and others."""

import sys

import numpy as np
import pyarrow  # type: ignore[import-untyped]
import pytest

import crawler2d as c2d
from crawler2d.common.arrays import Table
from tests.shared import ROBOT

WHEELS = ROBOT.with_track(c2d.LineOfWheels(4))


@pytest.fixture(scope="module")
def jammed() -> c2d.Run:
    """A run with stops and intrusions."""
    return c2d.simulate(WHEELS, c2d.terrains.step(0.1))


@pytest.fixture(scope="module")
def undisturbed() -> c2d.Run:
    """A run without events."""
    return c2d.simulate(WHEELS, c2d.terrains.flat(), duration=0.1)


def tables(run: c2d.Run) -> dict[str, Table]:
    simulation = c2d.Simulation(run.scenario)
    simulation.advance(3.0)
    return {
        "contacts": run.contacts,
        "events": run.events,
        "edges": run.edges,
        "bodies": run.bodies,
        "wheels": run.scenario.robot.wheels(),
        "intrusions": simulation.intrusions(),
        "state": simulation.state().contacts,
    }


def test_every_table_of_a_run_keeps_its_columns_and_values(jammed: c2d.Run) -> None:
    for name, table in tables(jammed).items():
        made = pyarrow.table(table)
        assert made.column_names == list(table), name
        assert made.num_rows == len(table) > 0, name
        for column, values in table.items():
            expected = [_plain(each) for each in values.tolist()]
            np.testing.assert_equal(made[column].to_pylist(), expected)


def _plain(value: object) -> object:
    if isinstance(value, np.ndarray):
        return value.tolist()
    return list(value) if isinstance(value, tuple) else value


def test_a_table_without_rows_has_the_types_of_one_with_rows(
    jammed: c2d.Run, undisturbed: c2d.Run
) -> None:
    full, empty = tables(jammed), tables(undisturbed)
    without = {name for name, table in empty.items() if not len(table)}
    assert {"events", "edges", "intrusions"} <= without
    for name in full:
        assert pyarrow.table(empty[name]).schema == pyarrow.table(full[name]).schema, name


def test_tuples_are_lists_of_whole_numbers_and_outlines_lists_of_points(jammed: c2d.Run) -> None:
    whole, number = pyarrow.int64(), pyarrow.float64()
    assert pyarrow.table(jammed.events).schema.field("bodies").type == pyarrow.list_(whole)
    outline = pyarrow.table(jammed.bodies).schema.field("outline").type
    assert outline == pyarrow.list_(pyarrow.list_(number))


def test_columns_of_numbers_are_not_copied(jammed: c2d.Run) -> None:
    made = pyarrow.table(jammed.contacts)
    for name, values in jammed.contacts.items():
        (chunk,) = made[name].chunks
        assert chunk.buffers()[1].address == values.ctypes.data, name


def test_any_reader_of_streams_takes_a_table(jammed: c2d.Run) -> None:
    reader = pyarrow.RecordBatchReader.from_stream(jammed.events)
    assert reader.read_all().to_pylist() == pyarrow.table(jammed.events).to_pylist()


def test_without_pyarrow_the_error_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(ImportError, match=r"this needs pyarrow: pip install 'crawler2d\[files\]'"):
        Table({"x": [0.0]}).__arrow_c_stream__()
