"""Other robots of an audit: the belt for comparison, and candidates for a repair."""

from dataclasses import replace
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d.audits.candidates import candidates_of, wheel_count
from crawler2d.audits.runs import belt_of
from tests.audits.seizing import SEIZING

# The belt for comparison


def test_the_belt_follows_the_outlines_where_these_are_the_models_own() -> None:
    belt = belt_of(c2d.robots.absolem(track="public")).robot
    assert belt.track == c2d.BeltTrack()
    assert belt.flippers is not None
    assert belt.flippers.track == c2d.BeltTrack()


@pytest.mark.parametrize("track", [c2d.HybridWheels(((-0.18, 0, 0.06), (0.18, 0, 0.06)))])
def test_round_placed_wheels_it_is_closed(track: c2d.HybridWheels) -> None:
    belt = belt_of(SEIZING.with_track(track))
    assert belt.robot.track == c2d.ClosedTrack(track)
    assert "placed one by one" in belt.reason


def test_a_motor_a_wheel_becomes_one_a_belt() -> None:
    own = replace(SEIZING, drivetrain=replace(SEIZING.drivetrain, torque_sharing="wheel"))
    assert belt_of(own).robot.drivetrain.torque_sharing == "track"


# Candidates


def test_candidates_keep_the_carriers_that_do_not_seize() -> None:
    robot = c2d.robots.absolem(track="public")
    for each in candidates_of(robot, ["flippers"]):
        assert each.robot.track == robot.track
        assert each.description.startswith("flippers: ")
    for each in candidates_of(robot, ["chassis"]):
        assert each.robot.flippers == robot.flippers


def test_wheels_of_both_ends_count_as_changed() -> None:
    robot = c2d.robots.absolem(track="public")
    one_more = candidates_of(robot, ["flippers"])[0]
    assert (one_more.change, wheel_count(one_more.robot) - wheel_count(robot)) == (2, 2)


def test_arms_that_take_the_robots_track_keep_their_wheels() -> None:
    robot = c2d.robots.engineer(track=c2d.LineOfWheels(3))
    for each in candidates_of(robot, ["chassis"]):
        assert each.robot.flippers is not None
        assert each.robot.flippers.track == c2d.LineOfWheels(3)


def test_placed_wheels_get_one_more_in_the_deepest_pocket() -> None:
    placed = c2d.HybridWheels(((-0.18, 0, 0.064), (-0.06, 0, 0.064), (0.18, 0, 0.064)))
    (first, *_) = candidates_of(SEIZING.with_track(placed), ["chassis"])
    assert first.description == "chassis: one wheel more, between wheels 1 and 2"
    assert first.robot.track.placements[2] == pytest.approx((0.06, 0.0, 0.064))  # type: ignore[union-attr]


def test_the_deepest_pocket_is_that_of_the_changed_carrier_also_on_arms_at_both_ends() -> None:
    # The rear arm is listed from its tip, with its pockets in reverse order.
    placed = c2d.HybridWheels(((0.05, 0, 0.05), (0.12, 0, 0.045), (0.2, 0, 0.04)))
    built = c2d.robots.engineer().flippers
    assert built is not None
    arms = replace(built, ends="both", track=placed)
    robot = c2d.robots.engineer(flippers=arms, track=c2d.LineOfWheels(4))
    first = next(each for each in candidates_of(robot, ["flippers"]) if each.kind == "wheels")
    assert first.description == "flippers: one wheel more, between wheels 1 and 2"
    assert first.robot.flippers is not None
    assert isinstance(first.robot.flippers.track, c2d.HybridWheels)
    new = set(first.robot.flippers.track.placements) - set(placed.placements)
    assert [x for x, _, _ in new] == [pytest.approx(0.16)]


@pytest.mark.parametrize("inner", [(-0.06, 0.0, 0.064), (-0.06, 0.01, 0.03)])
def test_a_wheel_inside_another_one_has_no_pocket_with_it(inner: Any) -> None:
    placed = ((-0.18, 0.0, 0.064), (-0.06, 0.0, 0.064), inner, (0.18, 0.0, 0.064))
    robot = replace(c2d.robots.engineer(flippers=None), track=c2d.HybridWheels(placed))
    first = next(each for each in candidates_of(robot, ["chassis"]) if each.kind == "wheels")
    assert first.description.endswith("and 3")


@pytest.mark.parametrize("count", [2, 4, 9])
def test_every_number_up_to_one_more_wheel_between_every_two_is_a_candidate(count: int) -> None:
    robot = SEIZING.with_track(c2d.LineOfWheels(count))
    counts = {
        each.robot.track.count
        for each in candidates_of(robot, ["chassis"])
        if isinstance(each.robot.track, c2d.LineOfWheels)
    }
    assert counts >= set(range(count + 1, 2 * count))


def test_belts_have_no_candidates() -> None:
    assert candidates_of(c2d.robots.engineer(), ["chassis", "flippers"]) == []
