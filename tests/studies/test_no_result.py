"""Figures and texts of studies without results show no NaN."""

from typing import Any

import matplotlib as mpl
import pytest
from matplotlib.text import Text

import crawler2d as c2d
from crawler2d.results.record import Row
from crawler2d.sweeps.collect import Collector
from tests.shared import ROBOT

FEW: Any = {"until": c2d.Until(min_runs=1, max_runs=2, width=1.0), "progress": False}
SHORT = c2d.Scenario(ROBOT, c2d.terrains.step(0.03), duration=0.1)
WHEELS = {"five": c2d.LineOfWheels(5), "four": c2d.LineOfWheels(4)}

mpl.use("agg")


@pytest.fixture(autouse=True)
def _diverging(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let every run diverge."""
    whole = Collector.rows

    def rows_of(*given: Any) -> list[Row]:
        error = c2d.SimulationDiverged("chassis is not finite")
        return [Row.of_error(error, row.identity, row.scenario) for row in whole(*given)]

    monkeypatch.setattr(Collector, "rows", rows_of)


def drawn(found: Any) -> list[str]:
    """The texts of the figure of a study, without NaN."""
    texts = [text.get_text() for text in found.plot().figure.findobj(Text)]
    assert not [text for text in texts if "nan" in text.lower()]
    return texts


def test_bars_of_outcomes_have_no_rate() -> None:
    found = c2d.studies.success_rate(SHORT, terrains={"step": SHORT.terrain}, models=WHEELS, **FEW)
    assert drawn(found).count("no result in 2 runs") == 2


def test_a_search_confirms_nothing() -> None:
    found = c2d.studies.search(SHORT, WHEELS, first=2, confirm=2, progress=False)
    assert "No fresh run of the winner five has a result." in found.attrs["verdict"]
    assert "nan" not in found.attrs["verdict"]
    assert "winner: five, no fresh run has a result" in drawn(found)


def test_a_map_has_cells_without_runs() -> None:
    x, y = ("terrain.height", [0.02, 0.05]), ("terrain.friction", [0.5, 0.9])
    found = c2d.studies.seizure_map(SHORT, x, y, **FEW)
    assert any("no run has a result" in text for text in drawn(found))
