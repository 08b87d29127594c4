"""Whatever happens in one run, the others return results and the interpreter continues."""

import platform
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d import errors

ENGINEER = c2d.robots.engineer(flippers=None)
STEP = c2d.Scenario(ENGINEER, c2d.terrains.step(0.05), duration=2.0)


@pytest.mark.parametrize("speed", [1e-20, -1e-20, 1e-300, 2.3e-308])
def test_a_speed_near_zero_runs_to_its_end(speed: float) -> None:
    run = c2d.simulate(STEP.replace({"drive.speed": speed}), record="summary")
    assert run.outcome is c2d.Outcome.TIMED_OUT
    sim = c2d.Simulation(STEP)
    sim.command(speed=speed)
    sim.advance(2.0)
    assert sim.time == pytest.approx(2.0)


def test_a_slow_command_is_never_called_a_stop_before_its_window_is_over() -> None:
    run = c2d.simulate(STEP.replace({"drive.speed": 0.001, "duration": 30.0}), record="summary")
    assert len(run.events) == 0


def test_a_history_that_outgrows_memory_takes_no_other_run_with_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # More contacts than expected: all wheels bear all the time.
    wheels = ENGINEER.with_track(c2d.LineOfWheels(200))
    base = c2d.Scenario(wheels, c2d.terrains.flat(), drive=c2d.Drive(speed=0.0))
    long = base.replace({"duration": 100.0, "criteria.stop_window": 1000.0})
    short = base.replace({"duration": 0.1})
    # The estimated memory of the batch is just available; the first run's record takes twice that.
    monkeypatch.setenv("CRAWLER2D_MEMORY", "0.145")
    runs = c2d.simulate_many([long, short, short], threads=1, on_error="record")
    assert isinstance(runs[0].error, errors.LimitError)
    assert "CRAWLER2D_MEMORY" in str(runs[0].error)
    assert [run.outcome for run in runs[1:]] == [c2d.Outcome.TIMED_OUT] * 2
    with pytest.raises(errors.LimitError, match="recorded so far"):
        c2d.simulate(long)


def test_a_batch_is_counted_as_a_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CRAWLER2D_MEMORY", "0.05")
    c2d.simulate_many([STEP] * 10)
    with pytest.raises(errors.LimitError, match="a batch of 200 runs") as caught:
        c2d.simulate_many([STEP] * 200)
    needed, available = caught.value.needed, caught.value.available
    assert needed is not None
    assert available is not None
    assert available < needed < 5 * available
    assert len(c2d.simulate_many([STEP] * 200, record="summary")) == 200


@pytest.mark.parametrize("text", ["", "much", "-1", "nan", "0"])
def test_an_invalid_memory_limit_is_refused(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CRAWLER2D_MEMORY", text)
    with pytest.raises(errors.LimitError, match="CRAWLER2D_MEMORY must be a number of GiB > 0"):
        c2d.simulate(STEP)


def test_a_name_of_a_hundred_megabytes_is_refused() -> None:
    with pytest.raises(errors.ScenarioError, match=r"scenario must be at most 64 MiB"):
        c2d.simulate(replace(ENGINEER, name="x" * 100_000_000), c2d.terrains.flat())
    with pytest.raises(errors.ScenarioError, match=r"robot\.name must have at most 1000"):
        c2d.simulate(replace(ENGINEER, name="x" * 1001), c2d.terrains.flat())
    assert replace(ENGINEER, name="x" * 1000).wheels() is not None


@pytest.mark.parametrize(
    ("track", "pitch", "most"),
    [
        (c2d.GrouserBeltTrack(), 3e-3, 200),
        (c2d.GrouserBeltTrack(), 1e-3, 200),
        (c2d.SegmentalTrack(), 1e-3, 400),
    ],
)
def test_a_number_of_grousers_left_to_the_program_has_the_bounds_of_a_given_one(
    track: c2d.GrouserBeltTrack | c2d.SegmentalTrack, pitch: float, most: int
) -> None:
    outline = replace(
        ENGINEER.outline, axle_distance=20.0, grouser_pitch=pitch, grouser_thickness=5e-4
    )
    robot = replace(
        ENGINEER.with_track(track), outline=outline, belly=None, moment_of_inertia=900.0
    )
    with pytest.raises(errors.ScenarioError, match=f"at most {most} grousers on a belt") as caught:
        c2d.simulate(robot, c2d.terrains.flat())
    assert caught.value.path == "robot.outline.grouser_pitch"


def test_rounded_edges_without_number_are_refused_before_they_are_cut() -> None:
    x = np.arange(100_000) * 1e-3
    teeth = c2d.terrains.from_points(
        np.column_stack([x, 1e-3 * (np.arange(x.size) % 2)]), goal=50.0, edge_radius=1e-6
    )
    with pytest.raises(errors.ScenarioError, match="must be 0 on a ground with so many edges"):
        c2d.simulate(ENGINEER, teeth)


ROUNDING = """
import ctypes, crawler2d as c2d
scenario = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05))
sim = c2d.Simulation(scenario)
sim.advance(0.1)
ctypes.CDLL(None).fesetround({mode})
calls = (
    lambda: c2d.simulate(scenario),
    lambda: c2d.simulate_many([scenario] * 3, threads=2),
    lambda: sim.advance(0.1),
    lambda: c2d.Simulation(scenario),
    scenario.validate,
)
refused = 0
for call in calls:
    try:
        call()
    except c2d.errors.InternalError as error:
        refused += "fesetround" in str(error)
ctypes.CDLL(None).fesetround(0)
again = c2d.simulate(scenario).metrics == c2d.simulate(scenario).metrics
print(refused, len(calls), again)
"""


@pytest.mark.skipif(
    (sys.platform, platform.machine()) != ("linux", "x86_64"),
    reason="the codes of the modes are those of x86",
)
@pytest.mark.parametrize("mode", [0x400, 0x800, 0xC00], ids=["down", "up", "towards zero"])
def test_another_rounding_mode_is_refused(mode: int) -> None:
    done = subprocess.run(
        [sys.executable, "-c", ROUNDING.format(mode=mode)],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split() == ["5", "5", "True"]


def test_planned_runs_on_more_ground_than_there_is_memory_for_are_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    x = np.linspace(-50.0, 50.0, 20_000)
    rough = np.column_stack([x, 0.01 * np.random.default_rng(0).random(len(x))])
    ground = c2d.terrains.from_points(rough, goal=40.0, friction=0.8)
    scenario = c2d.Scenario(c2d.robots.engineer(flippers=None), ground, duration=0.01)
    monkeypatch.setenv("CRAWLER2D_MEMORY", "0.05")
    with pytest.raises(c2d.LimitError, match="grounds of planned runs"):
        c2d.sweep(scenario, {"terrain.friction": np.linspace(0.5, 1.0, 20)}, progress=False)


@pytest.mark.parametrize("interval", [1e-17, 1e-18, 1e-20, 1e-300])
def test_a_record_of_any_number_of_samples_is_refused_before_the_run(interval: float) -> None:
    with pytest.raises(c2d.LimitError, match="sampled every"):
        c2d.simulate(STEP, duration=0.2, sample_interval=interval)
