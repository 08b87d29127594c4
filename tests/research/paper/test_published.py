"""The paper's tables: as printed, and in SI."""

import math

import pytest

import crawler2d as c2d
from research import paper
from research.models import study_models


def test_the_heights_of_table_3_are_metres() -> None:
    heights = {row.model: row.max_height for row in paper.TABLE_3}
    assert heights == {
        paper.REAL_ROBOT: 0.20,
        paper.CWA_ROUND: 0.10,
        paper.LWA_ROUND: 0.15,
        paper.CWA_GEAR: 0.20,
        paper.LWA_GEAR: 0.20,
    }


def test_the_shares_of_table_2_are_those_of_20_runs() -> None:
    shares = [share for row in paper.TABLE_2 for share in (row.cwa, row.lwa, row.gear)]
    assert shares == [0.0, 0.15, 1.0, 0.0, 0.10, 1.0, 0.0, 0.0, 0.40]
    assert all(20 * share == pytest.approx(round(20 * share)) for share in shares)


def test_tables_1_and_3_agree_on_the_real_robot() -> None:
    (robot,) = (row for row in paper.TABLE_3 if row.model == paper.REAL_ROBOT)
    assert robot.max_speed == paper.TABLE_1.max_speed
    assert robot.max_turn_rate == paper.TABLE_1.max_turn_rate
    # Table 1 prints 1 cm, Table 3 prints 0.02 m: both are kept as printed.
    assert (paper.TABLE_1.stopping_distance, robot.braking_distance) == (0.01, 0.02)


def test_a_turn_rate_of_8_5_revolutions_a_minute_is_0_89_radians_a_second() -> None:
    assert paper.TABLE_1.max_turn_rate == pytest.approx(8.5 * 2.0 * math.pi / 60.0)


def test_the_preset_has_the_measured_acceleration_and_the_declared_speed() -> None:
    drivetrain = c2d.robots.engineer(flippers=None).drivetrain
    (robot,) = (row for row in paper.TABLE_3 if row.model == paper.REAL_ROBOT)
    assert drivetrain.max_acceleration == robot.acceleration
    assert drivetrain.max_speed == paper.TABLE_1.declared_max_speed
    # From 0.4 m/s in 2 cm.
    assert drivetrain.max_deceleration == pytest.approx(0.4**2 / 2.0 / robot.braking_distance)


def test_every_model_of_table_3_has_one_of_ours() -> None:
    ours = {model.row for model in study_models().values()}
    assert ours - {None} == {row.model for row in paper.TABLE_3} - {paper.REAL_ROBOT}
