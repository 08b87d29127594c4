"""Pockets and slots between wheels, against closed forms and against points on circles."""

import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

import crawler2d as c2d
from crawler2d.audits.candidates import pocket_between, pockets
from crawler2d.audits.page.drawings import draw_pockets
from crawler2d.audits.text import _pockets


@pytest.mark.parametrize(("radius", "apart"), [(0.089, 0.5 / 7.0), (0.1, 0.12), (0.1, 0.199)])
def test_between_equal_wheels_depth_and_friction_are_those_of_the_closed_form(
    radius: float, apart: float
) -> None:
    width, gap, depth, friction = pocket_between((0.0, 0.0, radius), (apart, 0.0, radius))
    assert gap == 0.0
    assert width == pytest.approx(apart)
    assert depth == pytest.approx(radius - math.sqrt(radius**2 - apart**2 / 4.0))
    assert friction == pytest.approx(math.tan(math.asin(apart / (2.0 * radius))))


def test_wheels_that_touch_hold_at_any_friction() -> None:
    _, gap, depth, friction = pocket_between((0.0, 0.0, 0.1), (0.2, 0.0, 0.1))
    assert gap == 0.0
    assert depth == pytest.approx(0.1)
    assert friction > 1e6


def test_between_wheels_that_stand_apart_is_a_slot() -> None:
    width, gap, depth, friction = pocket_between((0.0, 0.0, 0.1), (0.226, 0.0, 0.1))
    assert [width, gap] == pytest.approx([0.226, 0.026])
    assert math.isinf(depth)
    assert math.isinf(friction)


@given(
    rear=st.floats(0.05, 0.2),
    front=st.floats(0.05, 0.2),
    share=st.floats(0.05, 0.95),
    slope=st.floats(-0.5, 0.5),
)
def test_the_bottom_of_a_pocket_lies_on_both_wheels_of_any_size(
    rear: float, front: float, share: float, slope: float
) -> None:
    """In the frame of the belt: axles at (0, rear) and (width, front), the bottom at `depth`."""
    apart = abs(rear - front) + share * (rear + front - abs(rear - front))
    place = (apart * math.cos(slope), apart * math.sin(slope), front)
    width, _, depth, friction = pocket_between((0.0, 0.0, rear), place)
    ahead = math.sqrt(max(rear**2 - (rear - depth) ** 2, 0.0))
    # One of the two points of the rear wheel at that height is on the front wheel.
    off = [math.hypot(width - x, front - depth) - front for x in (ahead, -ahead)]
    assert min(map(abs, off)) < 1e-6
    if depth < rear:
        assert friction == pytest.approx(ahead / (rear - depth), abs=1e-5)


@given(st.floats(0.05, 0.2), st.floats(0.05, 0.2), st.floats(0.05, 0.95))
def test_seen_from_behind_a_pocket_is_as_wide_and_as_deep(a: float, b: float, share: float) -> None:
    apart = abs(a - b) + share * (a + b - abs(a - b))
    there = pocket_between((0.0, 0.0, a), (apart, 0.0, b))
    back = pocket_between((0.0, 0.0, b), (apart, 0.0, a))
    assert there[:3] == pytest.approx(back[:3], abs=1e-9)


def test_the_public_absolem_has_pockets_from_tip_to_tip() -> None:
    robot = c2d.robots.absolem(track="public")
    found = pockets(robot)
    assert [each.is_slot for each in found].count(True) == 2  # one at each tip
    slots = [each.gap for each in found if each.is_slot]
    assert slots == pytest.approx([0.0095, 0.0095], abs=1e-6)
    track = [each for each in found if each.carrier == "chassis"]
    assert len(track) == 7
    assert all(round(1e3 * each.depth, 1) == 7.5 for each in track)
    assert all(round(each.friction, 2) == 0.44 for each in track)
    for first, second in itertools.pairwise(found):  # the root of an arm hides no wheel
        assert first.bodies[1] == second.bodies[0]


def test_the_wheels_of_an_axle_are_one() -> None:
    robot = c2d.robots.absolem(track="public")
    between = [each.carrier for each in pockets(robot) if "and" in each.carrier]
    assert between == ["rear flipper and chassis", "chassis and front flipper"]


def test_marv_is_open_between_its_flippers() -> None:
    found = [each for each in pockets(c2d.robots.marv(track="public")) if each.is_slot]
    assert [each.carrier for each in found] == ["chassis"]
    assert found[0].gap == pytest.approx(0.512 - 2.0 * 0.1165)


def test_wheels_all_round_show_those_of_the_lower_run() -> None:
    robot = c2d.robots.engineer(flippers=None, track=c2d.CircumferentialWheels(24))
    found = pockets(robot)
    assert 0 < len(found) < 24
    assert all(0.0 < each.depth <= robot.outline.front_radius for each in found)


def test_a_belt_has_no_pockets() -> None:
    assert pockets(c2d.robots.engineer()) == ()


def test_a_robot_without_neighbouring_wheels_has_no_pockets_to_draw() -> None:
    assert draw_pockets(c2d.robots.engineer(), ()) == (
        "<p>None: there are no neighbouring wheels.</p>"
    )


def test_a_robot_without_neighbouring_wheels_has_no_pockets_in_words() -> None:
    assert list(_pockets(())) == ["Pockets: none, because there are no neighbouring wheels"]
