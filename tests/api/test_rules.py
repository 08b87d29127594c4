"""Rules of calls that are rarely broken: each error names the argument."""

from pathlib import Path
from typing import Any

import pytest

import crawler2d as c2d
from tests.shared import ROBOT, refused

STEP = c2d.terrains.step(0.05)
BRIEF = c2d.Scenario(ROBOT, STEP, duration=0.1)


class Broken:
    """An object that raises when its numbers are read."""

    def __array__(self, *_: Any, **__: Any) -> Any:
        raise RuntimeError("no numbers")


def test_a_world_has_a_terrain(tmp_path: Path) -> None:
    terrain: Any = "step"
    error = refused(lambda: ROBOT.to_world(tmp_path / "world.sdf", terrain))
    assert (error.path, error.rule) == ("terrain", "must be a terrain")
    assert not any(tmp_path.iterdir())


def test_a_robot_gets_flippers_and_nothing_else() -> None:
    arms: Any = "arms"
    error = refused(lambda: ROBOT.with_flippers(arms))
    assert (error.path, error.rule) == ("robot.flippers", "must be a Flippers")


def test_an_array_that_cannot_be_read_is_refused_by_the_name_of_its_field() -> None:
    broken: Any = Broken()
    error = refused(lambda: c2d.simulate(BRIEF.replace({"robot.center_of_mass": broken})))
    assert error.path == "robot.center_of_mass"
    error = refused(lambda: c2d.terrains.from_points(broken, goal=0.0))
    assert error.path.endswith("points")


def test_the_history_of_a_run_is_read_only(run: c2d.Run) -> None:
    with pytest.raises(AttributeError, match="velocity is read-only"):
        run.velocity = 0


def test_simulations_are_reset_with_one_scenario_each() -> None:
    many = c2d.Simulations([BRIEF] * 3)
    error = refused(lambda: many.reset([0, 2], [BRIEF]))
    assert (error.path, error.rule) == ("scenarios", "must be 2 of them")


@pytest.mark.parametrize("level", [0.0, 1.0])
def test_rates_are_of_a_confidence_between_0_and_1(level: float) -> None:
    error = refused(lambda: c2d.rate(["cleared"], confidence_level=level))
    assert (error.path, error.rule) == ("confidence_level", "must be between 0 and 1")
    assert c2d.rate(["cleared"], confidence_level=0.5)["low"].item() > 0.5


def test_the_progress_of_an_audit_is_shown_or_called() -> None:
    progress: Any = 3
    error = refused(lambda: c2d.audit(ROBOT.with_track(c2d.LineOfWheels(3)), progress=progress))
    assert (error.path, error.rule) == ("progress", "must be True, False or a callable")


@pytest.mark.parametrize(
    ("track", "words"),
    [
        (c2d.BeltTrack(), "smooth belt"),
        (c2d.GrouserBeltTrack(), "belt with grousers"),
        (c2d.CircumferentialWheels(12), "12 round wheels all round"),
        (c2d.ForceTrack(), "skids pushed by a force"),
        (c2d.ForceTrack(support="wheels", wheel_count=7), "7 free wheels pushed by a force"),
        (c2d.ClosedTrack(c2d.LineOfWheels(3)), "belt closed round 3 round wheels in a line"),
        (c2d.SegmentalTrack(), "chain of shoes on a guide"),
        (c2d.SegmentalTrack(mechanism="sprocket"), "chain of shoes round a sprocket"),
    ],
)
def test_a_track_says_what_it_is(track: Any, words: str) -> None:
    assert track.description == words
