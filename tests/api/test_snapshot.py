"""Snapshots: a simulation continues from its bytes, and other bytes are refused."""

import hashlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from tests.shared import VARIANTS

DIGEST = 32


def same(one: c2d.Simulation, other: c2d.Simulation) -> bool:
    """Whether two simulations are in the same state, to the last bit."""
    return one.snapshot() == other.snapshot()


@pytest.mark.parametrize("scenario", VARIANTS.values(), ids=VARIANTS)
def test_a_simulation_goes_on_from_its_snapshot_with_the_same_bits(scenario: Scenario) -> None:
    sim = c2d.Simulation(scenario)
    sim.advance(0.7)
    copy = c2d.Simulation.from_snapshot(sim.snapshot())
    assert copy.scenario == scenario
    assert copy.time == sim.time == pytest.approx(0.7)
    assert same(sim, copy)
    for each in (sim, copy):
        each.advance(0.5)
    assert same(sim, copy)
    assert np.array_equal(sim.state().position, copy.state().position)
    assert sim.state().contacts["normal_force"].tolist() == (
        copy.state().contacts["normal_force"].tolist()
    )


def test_a_copy_is_independent(scenario: Scenario) -> None:
    sim = c2d.Simulation(scenario)
    sim.advance(0.5)
    snapshot = sim.snapshot()
    copy = c2d.Simulation.from_snapshot(snapshot)
    copy.command(speed=-0.2)
    copy.advance(1.0)
    assert sim.snapshot() == snapshot
    again = c2d.Simulation.from_snapshot(snapshot)
    for each in (sim, again):
        each.advance(1.0)
    assert same(sim, again)
    assert not same(sim, copy)


def test_a_command_and_a_push_go_with_the_snapshot(scenario: Scenario) -> None:
    flat = scenario.replace({"terrain": c2d.terrains.flat()})
    sim, plain = c2d.Simulation(flat), c2d.Simulation(flat)
    sim.command(speed=0.0, push=-20.0)
    for each in (sim, plain):
        each.advance(0.5)
    copy = c2d.Simulation.from_snapshot(sim.snapshot())
    for each in (sim, copy):
        each.advance(1.0)
    assert same(sim, copy)
    assert copy.state().commanded_speed == 0.0
    # Without the push, the copy would continue differently.
    let_go = c2d.Simulation.from_snapshot(copy.snapshot())
    let_go.command(push=0.0)
    assert not same(let_go, copy)


def test_a_push_beyond_friction_moves_a_standing_robot() -> None:
    ground = c2d.terrains.flat(friction=0.5)
    sim = c2d.Simulation(
        Scenario(
            c2d.robots.engineer(flippers=None), ground, drive=c2d.Drive(speed=0.0), duration=1.0
        )
    )
    sim.advance(0.5)
    limit = 0.5 * sim.scenario.robot.mass * sim.scenario.gravity
    before = sim.state().position[0]
    for push, moves in ((0.9 * limit, False), (-1.2 * limit, True)):
        sim.command(push=push)
        sim.advance(0.5)
        moved = sim.state().position[0] - before
        assert (moved < -0.05) if moves else (abs(moved) < 1e-3)


@pytest.mark.parametrize("push", [np.nan, np.inf, 1.1e15, -1.1e15, "1", True, [1.0], 1j])
def test_an_impossible_push_is_refused_and_changes_nothing(scenario: Scenario, push: Any) -> None:
    sim = c2d.Simulation(scenario)
    before = sim.snapshot()
    with pytest.raises(c2d.ScenarioError) as caught:
        sim.command(push=push)
    assert caught.value.path == "push"
    assert sim.snapshot() == before


def test_a_stop_is_remembered(scenario: Scenario) -> None:
    seizing = scenario.replace(
        {"robot.track": c2d.LineOfWheels(4), "terrain.height": 0.10, "duration": 10.0}
    )
    sim = c2d.Simulation(seizing)
    sim.advance(5.0)
    copy = c2d.Simulation.from_snapshot(sim.snapshot())
    whole, told = sim.diagnosis(), copy.diagnosis()
    assert whole is not None
    assert str(told) == str(whole)
    assert told is not None
    assert (told.time, told.since) == (whole.time, whole.since)


@pytest.mark.parametrize("kind", [bytes, bytearray, memoryview])
def test_any_kind_of_bytes_will_do(scenario: Scenario, kind: Any, tmp_path: Path) -> None:
    sim = c2d.Simulation(scenario)
    sim.advance(0.3)
    path = tmp_path / "run.snapshot"
    path.write_bytes(sim.snapshot())
    assert same(c2d.Simulation.from_snapshot(kind(path.read_bytes())), sim)


@pytest.mark.parametrize("wrong", [None, "bytes", 7, [1, 2], np.zeros(4, np.uint8), object()])
def test_anything_but_bytes_is_refused(wrong: Any) -> None:
    with pytest.raises(c2d.ScenarioError, match="must be bytes") as caught:
        c2d.Simulation.from_snapshot(wrong)
    assert caught.value.path == "snapshot"


def damaged(snapshot: bytes) -> dict[str, bytes]:
    middle = len(snapshot) // 2
    flipped = bytes([snapshot[middle] ^ 1])
    return {
        "empty": b"",
        "foreign": b"\x89PNG\r\n\x1a\n" + snapshot,
        "its head alone": snapshot[:21],
        "cut": snapshot[:-1],
        "cut in half": snapshot[:middle],
        "longer": snapshot + b"\x00",
        "one bit": snapshot[:middle] + flipped + snapshot[middle + 1 :],
        "another version": snapshot.replace(b"snapshot 1", b"snapshot 9", 1),
        "scenario file": b'{"schema": 2}',
    }


@pytest.mark.parametrize("damage", damaged(bytes(100)))
def test_damaged_bytes_are_refused(scenario: Scenario, damage: str) -> None:
    snapshot = damaged(c2d.Simulation(scenario).snapshot())[damage]
    with pytest.raises(c2d.ScenarioError) as caught:
        c2d.Simulation.from_snapshot(snapshot)
    assert caught.value.path == "snapshot"
    assert caught.value.rule in (
        "must be a snapshot of crawler2d",
        "must be complete and unchanged",
    )


def test_the_snapshot_of_another_build_names_both(scenario: Scenario) -> None:
    own = str(c2d.build_info()["build_id"])
    other = own[::-1] if own != own[::-1] else "0" * len(own)
    body = c2d.Simulation(scenario).snapshot()[:-DIGEST].replace(own.encode(), other.encode(), 1)
    with pytest.raises(c2d.ScenarioError) as caught:
        c2d.Simulation.from_snapshot(body + hashlib.sha256(body).digest())
    assert caught.value.path == "snapshot"
    assert own in caught.value.rule
    assert other in str(caught.value.value)


FORGED = {
    "belt": c2d.robots.engineer(flippers=None),
    "gears": c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(3, wheel=c2d.GearWheel())),
    "arms": c2d.robots.engineer(track=c2d.LineOfWheels(4)),
    "chain": c2d.robots.engineer(flippers=None, track=c2d.SegmentalTrack()),
}


@pytest.mark.parametrize("robot", FORGED.values(), ids=FORGED)
def test_a_snapshot_changed_and_signed_again_is_refused_or_runs(robot: c2d.Robot) -> None:
    sim = c2d.Simulation(c2d.Scenario(robot, c2d.terrains.step(0.1)))
    sim.advance(1.5)
    whole = sim.snapshot()[:-DIGEST]
    rng = np.random.default_rng(7)
    told = {"refused": 0, "ran": 0, "diverged": 0}
    for _ in range(150):
        body = bytearray(whole)
        for place in rng.integers(100, len(body), rng.choice([1, 1, 3])):
            body[place] = rng.integers(256)
        try:
            forged = c2d.Simulation.from_snapshot(bytes(body) + hashlib.sha256(body).digest())
        except c2d.ScenarioError:
            told["refused"] += 1
            continue
        assert abs(forged.state().position[0]) < 1.2e6
        try:
            forged.advance(0.02)
            forged.intrusions()
            forged.diagnosis()
            told["ran"] += 1
            assert np.isfinite(forged.state().position).all()
        except c2d.SimulationDiverged:
            told["diverged"] += 1
    assert told["refused"] > 10
    assert told["ran"] > 10
