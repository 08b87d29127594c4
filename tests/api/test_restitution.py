"""Restitution of contacts in impacts."""

import pytest

import crawler2d as c2d


def scenario(restitution: float = 0.0) -> c2d.Scenario:
    robot = c2d.robots.engineer(flippers=None).without_rotors()
    edge = c2d.terrains.knife_edge(0.06, thickness=0.01, friction=0.9)
    small_wheels = robot.with_track(c2d.CircumferentialWheels(24))
    return c2d.Scenario(
        small_wheels, edge, drive=c2d.Drive(speed=0.4), solver=c2d.Solver(restitution=restitution)
    )


def test_a_jam_may_depend_on_restitution() -> None:
    jams, gets_over = (c2d.simulate(scenario(restitution=share)) for share in (0.0, 0.5))
    assert jams.outcome is c2d.Outcome.SEIZED
    assert gets_over.outcome is c2d.Outcome.CLEARED


def test_a_scenario_without_it_keeps_its_text() -> None:
    assert "restitution" not in scenario().to_json()
    given = scenario(restitution=0.5)
    assert c2d.Scenario.from_json(given.to_json()) == given


@pytest.mark.parametrize("share", [-0.1, 1.1, float("nan")])
def test_a_share_out_of_range_is_refused_by_its_path(share: float) -> None:
    with pytest.raises(c2d.ScenarioError, match=r"solver\.restitution"):
        scenario(restitution=share).validate()


def test_chains_and_rapier_have_no_restitution() -> None:
    chained = scenario(restitution=0.5).replace({"robot.track": c2d.SegmentalTrack()})
    with pytest.raises(c2d.ScenarioError, match=r"solver\.restitution .*segmental"):
        chained.validate()
    in_rapier = scenario().replace({"solver": c2d.Solver(engine="rapier", restitution=0.5)})
    with pytest.raises(c2d.ScenarioError, match=r"solver\.restitution"):
        in_rapier.validate()
