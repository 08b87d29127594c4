"""benches/scaling: its scenes run, its ground is as described, and its page reports results."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from benches.scaling import measure, plot, report, scenes
from benches.scaling.report import curves
from benches.scaling.scenes import Point
from benches.shared.measuring import write_parts
from crawler2d.parameters.terrain import Points, Terrain
from research.tables import splice

POINTS = list(scenes.points())
# A belt on more pieces takes seconds.
MOST = 1_000


def name(point: Point) -> str:
    return f"{point.figure}, {point.panel}, {point.curve}, {point.x}".replace(" ", "-")


@pytest.mark.parametrize("point", [p for p in POINTS if p.x <= MOST], ids=name)
def test_every_scene_runs(point: Point) -> None:
    simulation = c2d.Simulation(point.scenario)
    start = simulation.state().position
    simulation.advance(0.2)
    assert simulation.state().position[0] > start[0]


def test_every_scene_is_valid() -> None:
    # The others run; of these the ground alone is new, and takes its time.
    rest = {(point.panel, point.x): point for point in POINTS if point.x > MOST}
    for point in rest.values():
        point.scenario.validate()


def points_of(terrain: Terrain) -> np.ndarray[Any, Any]:
    assert isinstance(terrain, Points)
    return np.array(terrain.points)


def test_flat_ground_has_its_pieces() -> None:
    for count in scenes.PIECES:
        (point, *_) = (p for p in POINTS if p.panel == scenes.CUT and p.x == count)
        x, y = points_of(point.scenario.terrain).T
        assert len(x) == count + 1
        assert np.diff(x) == pytest.approx(6.0 / count)
        assert np.abs(y).max() <= scenes.JITTER


def test_blocks_keep_their_shape_however_finely_cut() -> None:
    middles = np.arange(-0.9, 5.0, 0.2)
    coarse, fine = (points_of(scenes.blocks(count)) for count in (100, 10_000))
    heights = [np.interp(middles, *ground.T) for ground in (coarse, fine)]
    assert np.abs(heights[0] - heights[1]).max() <= 2.0 * scenes.JITTER
    assert np.ptp(heights[0]) > 0.02


def result() -> dict[str, Any]:
    """The result of a run if a second cost x ms, plus one for each panel before."""
    rows: list[dict[str, Any]] = []
    panels = list(scenes.panels(POINTS))
    for point in POINTS:
        offset = panels.index((point.figure, point.panel))
        found = {"per_second": (point.x + offset) * 1e-3, "final_x": 1.0 + point.x}
        row = point._asdict() | found
        rows.append({key: value for key, value in row.items() if key != "scenario"})
    return {
        "machine": {
            "date": "2026-01-02",
            "processor": "Abacus 7",
            "cores": 2,
            "load": None,
            "system": "Linux",
            "python": "3.11.0",
            "versions": {"crawler2d": "1.2.3"},
        },
        "wall": 120.0,
        "rows": rows,
        "threads": [
            {"threads": 1, "real_time": 1e3, "worlds": 1.0, "loops": 1.0},
            {"threads": 2, "real_time": 1.8e3, "worlds": 1.8, "loops": 1.9},
        ],
    }


def test_the_report_has_all_figures_and_the_page_those_that_it_shows(tmp_path: Path) -> None:
    page, whole = tmp_path / "page.md", tmp_path / "report.md"
    page.write_text("# Title\n\n<!-- wheels -->\nold\n<!-- end of wheels -->\n", encoding="utf-8")
    write_parts(report.render(result()), page, whole)
    text = page.read_text(encoding="utf-8")
    assert text.startswith("# Title\n\n<!-- wheels -->\n\nCells: ms per")
    assert "old" not in text
    text = whole.read_text(encoding="utf-8")
    for part in ("2026-01-02", "in 2 minutes", "Abacus 7", "crawler2d (1.2.3)", "unknown"):
        assert part in text
    assert "| line, round | 3 to 96; 1.00, 1.00 |" in text
    assert "| 2 | 1,800x | 1.80 | 1.90 |" in text
    # The robot gets as many um farther as the accuracy is coarser.
    assert "| 10 | 6 | 7 | 0.0099 | 0.0099 |" in text
    # Whole ground costs 5 ms, the others 100,004.
    assert "| belt | 5 | 100,004 | 100,004 | 20000.80 | 20000.80 |" in text
    assert max(map(len, prose(text))) <= 100


def test_the_page_has_a_place_for_each_part() -> None:
    page = (Path(__file__).parents[2] / "docs" / "studies" / "scaling.md").read_text("utf-8")
    parts = report.render(result())
    shown = [parts["measured"], parts["wheels"]]
    assert all(text in splice(page, parts) for text in shown)


def prose(text: str) -> Sequence[str]:
    return [line for line in text.splitlines() if not line.startswith(("|", "!"))]


def test_slopes_are_exponents() -> None:
    rows = [
        {"figure": "f", "panel": "p", "curve": "c", "x": x, "per_second": 3e-6 * x**1.5}
        for x in (2.0, 4.0, 8.0)
    ]
    (curve,) = curves(rows, "f")
    assert (curve.slope, curve.last_slope) == pytest.approx((1.5, 1.5))


def test_threads_are_timed_by_what_other_processes_can_import(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """They import no `__main__` of a package; one process is enough to see that."""
    monkeypatch.setattr(os, "cpu_count", lambda: 1)
    for job in (measure.run, measure.threads):
        assert job.__module__ == "benches.scaling.measure"
    assert [row["threads"] for row in measure.threads(2, 1, 1)] == [1]


def test_figures_are_small_files(tmp_path: Path) -> None:
    plot.plot(result(), tmp_path)
    sizes = {path.stem: path.stat().st_size for path in tmp_path.iterdir()}
    assert set(sizes) == {"wheels", "grousers", "points", "threads", "accuracy"}
    assert max(sizes.values()) < 60_000
