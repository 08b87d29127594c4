"""Measure environment steps per second; the table goes to the terminal.

Usage, from the repository root: ``python -m benches.envs [--quick]``.
"""

from __future__ import annotations

import argparse
import resource
import sys
import time
from collections.abc import Callable, Mapping
from functools import partial
from itertools import product
from typing import Any

import numpy as np
import pymunk
from numpy.typing import NDArray

import crawler2d as c2d
from benches.envs.chipmunk_env import ChipmunkClimb
from benches.shared.measuring import machine
from benches.shared.results import progress
from crawler2d.envs import FlipperEnv, FlipperVectorEnv

_NOISE = 0.2
"""[-] Standard deviation of actions about driving on, like those of a policy that explores."""

_DT = 0.05
_COUNTS, _THREADS = (64, 256), (1, 2)
_MANY = 4096

Rate = tuple[float, float]
"""[1/s], [-] Steps, and the fraction of their time in the physics, if known."""

Job = Callable[[], Rate]

_DRIVE = c2d.Drive(speed=0.39)


def scenes() -> dict[str, c2d.Scenario]:
    """Return the scenarios by name."""
    engineer = c2d.robots.engineer(flippers=None)
    tracks: dict[str, Any] = {
        "Engineer, belt": c2d.BeltTrack(),
        "Engineer, 6 wheels": c2d.LineOfWheels(count=6),
        "Engineer, 6 gear wheels": c2d.LineOfWheels(count=6, wheel=c2d.GearWheel()),
    }
    robots = {"Absolem, belts, flippers": (c2d.robots.absolem(), 0.2)}
    robots |= {name: (engineer.with_track(track), 0.05) for name, track in tracks.items()}
    return {
        name: c2d.Scenario(robot, c2d.terrains.step(height), drive=_DRIVE, duration=10.0)
        for name, (robot, height) in robots.items()
    }


def actions(count: int, width: int, steps: int) -> NDArray[np.float64]:
    """Return actions that drive on with noise, shape (steps, count, width)."""
    noise = np.random.default_rng(0).standard_normal((steps, count, width))
    ahead = np.eye(1, width)[0]
    clipped: NDArray[np.float64] = np.clip(ahead + _NOISE * noise, -1.0, 1.0)
    return clipped


def width_of(scenario: c2d.Scenario) -> int:
    """Return the number of values of an action."""
    return 1 if scenario.robot.flippers is None else 3


def by_hand(scenario: c2d.Scenario, steps: int) -> Rate:
    """[1/s] Steps of a `Simulation` that is commanded, advanced, read and reset."""
    simulation, flippers = c2d.Simulation(scenario), scenario.robot.flippers
    given = actions(1, width_of(scenario), steps)[:, 0].tolist()
    begin = time.perf_counter()
    for action in given:
        simulation.command(speed=scenario.drive.speed * action[0])
        if flippers is not None:
            front, rear = (flippers.rate_limit * each for each in action[1:])
            simulation.command(flipper_rate=front, rear_flipper_rate=rear)
        simulation.advance(_DT)
        state = simulation.state()
        np.array([state.chassis_angle, state.track_speed, *state.flipper_angles], np.float32)
        if state.outcome is not None or state.time >= scenario.duration:
            simulation.reset()
    return steps / (time.perf_counter() - begin), np.nan


def alone(env: Any, steps: int) -> Rate:
    """[1/s] Steps of a single environment."""
    env.reset(seed=0)
    given = actions(1, env.action_space.shape[0], steps)[:, 0]
    begin = time.perf_counter()
    for action in given:
        _, _, terminated, truncated, _ = env.step(action)
        if terminated or truncated:
            env.reset()
    return steps / (time.perf_counter() - begin), np.nan


class _Timed:
    """The core, with the time spent in its physics."""

    def __init__(self, core: Any) -> None:
        self.core, self.seconds = core, 0.0

    def __getattr__(self, name: str) -> Any:
        return getattr(self.core, name)

    def advance(self, *arguments: Any) -> None:
        begin = time.perf_counter()
        self.core.advance(*arguments)
        self.seconds += time.perf_counter() - begin


def together(scenario: c2d.Scenario, count: int, threads: int, steps: int) -> Rate:
    """[1/s], [-] Steps of a vector environment, and the fraction of its time in the physics."""
    env = FlipperVectorEnv(count, scenario, threads=threads)
    env.reset(seed=0)
    many = env._begun()._many
    many._core = core = _Timed(many._core)  # type: ignore[assignment] # the same methods
    given = actions(count, width_of(scenario), steps)
    begin = time.perf_counter()
    for action in given:
        env.step(action)
    passed = time.perf_counter() - begin
    return count * steps / passed, core.seconds / passed


def gigabytes_of(scenario: c2d.Scenario, count: int) -> float:
    """[GB] Peak memory of this process with a number of environments in their first second."""
    env = FlipperVectorEnv(count, scenario)
    env.reset(seed=0)
    for action in actions(count, width_of(scenario), 20):
        env.step(action)
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def main() -> None:
    """Measure all jobs in turns."""
    parser = argparse.ArgumentParser(prog="python -m benches.envs", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few steps, one round")
    quick = parser.parse_args().quick
    steps, rounds = (20, 1) if quick else (300, 3)
    about = machine({"crawler2d": c2d.__version__, "pymunk": pymunk.version})
    say(", ".join(f"{name} {value}" for name, value in about.items()))
    for name, scenario in scenes().items():
        jobs: dict[str, Job] = {
            "by hand": partial(by_hand, scenario, 4 * steps),
            "FlipperEnv": partial(alone, FlipperEnv(scenario), 4 * steps),
        }
        if scenario.robot.flippers is not None:
            jobs["the same in Chipmunk"] = partial(alone, ChipmunkClimb(scenario.robot, 0.2), steps)
        for count, threads in product(_COUNTS, _THREADS):
            label = f"{count} of FlipperVectorEnv, {threads} threads"
            jobs[label] = partial(together, scenario, count, threads, steps)
        report(name, jobs, rounds)
    absolem = next(iter(scenes().values()))
    count = 64 if quick else _MANY
    say(f"{count} of the Absolem: {gigabytes_of(absolem, count):.2f} GB of memory at most")


def report(name: str, jobs: Mapping[str, Job], rounds: int) -> None:
    """Return the most steps per second of each job, from several rounds of all jobs."""
    found = []
    for k in range(rounds):
        progress(f"{name}: round {k + 1} of {rounds}")
        found.append([job() for job in jobs.values()])
    best = [max(rates) for rates in zip(*found, strict=True)]
    say(f"\n{name}: steps of {_DT} s a second")
    for job, (rate, share) in zip(jobs, best, strict=True):
        physics = "" if np.isnan(share) else f"   {share:.0%} of it in the physics"
        say(f"  {job:36} {rate:8.0f}{physics}")


def say(line: str) -> None:
    """Write a line of the report."""
    sys.stdout.write(f"{line}\n")


if __name__ == "__main__":
    main()
