"""Units of tables are complete, and agree with the documentation."""

import inspect
import re

import pytest

import crawler2d as c2d
from crawler2d import _core
from crawler2d.common.units import METRICS, RENAMED_METRICS, unit_of
from crawler2d.parameters import (
    drivetrain,
    flippers,
    robot,
    scenario,
    settings,
    terrain,
    track,
)
from crawler2d.parameters.fields import Parameters
from crawler2d.pictures import page


def test_every_metric_has_a_unit(run: c2d.Run) -> None:
    assert set(run.metrics) == set(METRICS)


def test_a_metric_can_be_read_by_its_former_name_with_a_warning(run: c2d.Run) -> None:
    for before, now in RENAMED_METRICS.items():
        for look in (run.metrics.__getitem__, run.metrics.get):
            with pytest.warns(DeprecationWarning, match=f"{before!r} is called {now!r} now"):
                assert look(before) == run.metrics[now]
        assert before not in set(run.metrics)
    assert run.metrics.get("another") is None


def test_a_page_shows_figures_of_the_core_in_its_units() -> None:
    shown = {"s": {"s"}, "m": {"m", "mm"}, "rad": {"°"}, "J": {"J"}, "N": {"N"}}
    for name, _, factor, unit, _ in page._FIGURES:
        assert unit in shown[METRICS[name]]
        assert (abs(factor) == 1.0) == (unit == METRICS[name])


def test_settings_that_rapier_does_not_have_are_refused_unless_they_have_their_defaults() -> None:
    own = c2d.Solver()
    assert {name: getattr(own, name) for name in _core.own_settings()} == _core.own_settings()


@pytest.mark.parametrize(
    ("path", "unit"),
    [
        ("robot.center_of_mass[0]", "m"),
        ("terrain.left.points[3]", "m"),
        ("terrain.points[3][1]", "m"),
        ("robot.track.placements[0][2]", "m"),
        ("drive.schedule[0][0]", "s"),
        ("drive.schedule[12][1]", "m/s"),
        ("drive.gait.schedule[0][1]", "rad"),
        ("drive.schedule[0]", None),  # two units
        ("drive.schedule", None),
        ("robot.drivetrain.torque_curve[1][0]", "m/s"),
        ("robot.drivetrain.torque_curve[1][1]", "N m"),
    ],
)
def test_an_element_has_the_unit_of_its_column(path: str, unit: str | None) -> None:
    assert unit_of(path) == unit


def test_units_are_those_of_the_docstrings() -> None:
    documented: dict[str, str] = {}
    for module in (scenario, settings, robot, drivetrain, flippers, terrain, track):
        for kind in vars(module).values():
            if inspect.isclass(kind) and issubclass(kind, Parameters):
                text = inspect.getdoc(kind) or ""
                for names, unit in re.findall(r"^([\w, ]+) : .*\n +\[([^\]]+)\]", text, re.M):
                    paths = [f"{kind.default_path}.{name}" for name in names.split(", ")]
                    documented |= dict.fromkeys(paths, unit.replace("-", "1"))
    assert {path: unit_of(path) for path in documented} == documented
