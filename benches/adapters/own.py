"""crawler2d itself: on its own scenarios of the scenes, and next to engines in three dimensions.

The scenarios of the scenes are in `tests/scenarios`. One call simulates a whole run and is timed,
so the time includes building the model and the monitor that looks for stops. A stop window longer
than the run keeps runs from ending early, so that every engine simulates the same span. There are
no pins that could open.
"""

import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

import crawler2d as c2d
from benches.adapters.planar import Motion, Scene, Setting, to_world
from benches.shared.measuring import seconds
from crawler2d import Scenario, ScenarioError, SimulationDiverged, Solver, simulate_many

_SCENARIOS = Path(__file__).parents[2] / "tests" / "scenarios"
# [s] Longer than any run.
_NEVER = 1000.0


class Crawler2D:
    """Our own dynamics, in reduced coordinates."""

    name = "crawler2d"
    version = c2d.__version__
    defaults = Setting(accuracy=Solver().accuracy or 0.0, tuned=False)
    # The defaults in every scene, because users should not have to search for a setting.
    grid: Sequence[Setting] = [defaults]
    finest = Setting(accuracy=1e-8)
    next_finest = Setting(accuracy=4e-8)

    def wall_time(self, scene: Scene, setting: Setting, duration: float) -> float:
        """[s] Time a run."""
        ready = scenario(scene, setting, duration)
        start = time.perf_counter()
        with suppress(SimulationDiverged):
            c2d.simulate(ready, record="summary")
        return time.perf_counter() - start

    def record(self, scene: Scene, setting: Setting, duration: float, interval: float) -> Motion:
        """Run and sample all poses."""
        ready = scenario(scene, setting, duration)
        try:
            run = c2d.simulate(ready, sample_interval=interval)
        except SimulationDiverged:
            return Motion.of([0.0, duration], np.full((2, len(scene.bodies), 3), np.nan))
        poses = np.empty((len(run.time), len(scene.bodies), 3))
        poses[:, 0, :2], poses[:, 0, 2] = run.position, run.chassis_angle
        wheels = ready.robot.wheels()
        # Both sides are alike; take the left wheels.
        left = wheels["side"] == "left"
        centers, radii = np.column_stack([wheels["x"], wheels["y"]])[left], wheels["radius"][left]
        for index, joint in enumerate(scene.joints):
            # Wheels are counted along the belt here.
            drive = int(np.argmin(np.hypot(*(centers - joint.pa).T)))
            poses[:, index + 1, :2] = to_world(poses[:, 0], centers[drive])
            poses[:, index + 1, 2] = poses[:, 0, 2] - run.drive_positions[:, drive] / radii[drive]
        return Motion.of(run.time, poses, run.metrics["max_penetration"])

    def batch_time(self, variants: Sequence[Scene], setting: Setting, threads: int) -> float:
        """[s] Time worlds on several threads."""
        ready = [scenario(scene, setting, scene.duration) for scene in variants]
        return seconds(lambda: simulate_many(ready, threads=threads, record="summary"))


def scenario(scene: Scene, setting: Setting, duration: float) -> Scenario:
    """Return crawler2d's scenario of a scene, with the scene's draw."""
    base = nominal(scene.name)
    draw = scene.draw
    return base.replace(
        {
            "start.approach": base.start.approach + draw.approach,
            "drive.speed": base.drive.speed * draw.speed,
            "terrain.friction": scene.friction,
            "solver": Solver(accuracy=setting.accuracy),
            "duration": duration,
            "criteria.stop_window": _NEVER,
        }
    )


def nominal(name: str) -> Scenario:
    """Read crawler2d's scenario of a scene; a line of 3 is one of 5 without two of its wheels."""
    file = f"peer_{name.replace('lwa3', 'lwa5').replace('-', '_')}.json"
    base = Scenario.from_json((_SCENARIOS / file).read_text(encoding="utf-8"))
    if not name.startswith("lwa3"):
        return base
    wheels, robot = base.robot.wheels(), base.robot
    without = np.flatnonzero(np.isin(wheels["body"], (1, 3)))
    return base.replace(
        {
            # Each removed wheel, half of 1 kg, takes its mass and inertia with it.
            "robot.mass": robot.mass - 2.0,
            "robot.moment_of_inertia": robot.moment_of_inertia
            - sum(0.5 * wheels["x"][i] ** 2 + wheels["moment_of_inertia"][i] for i in without),
            "robot.track_mass": robot.track_mass * 3 / 5,
            "robot.drivetrain.max_torque": robot.drivetrain.max_torque * 3 / 5,
            "robot.track.count": 3,
        }
    )


def simulated(scenario: Scenario, engine: str | None = None) -> dict[str, Any]:
    """Simulate a scenario.

    Parameters
    ----------
    scenario : Scenario
        The scenario.
    engine : str, optional
        Of `Solver`; None takes its default.

    Returns
    -------
    dict
        As of `space.drive`, "end" being the outcome, with the mechanism of a stop and no heading;
        one that is refused ends so, with the path of the field.
    """
    if engine is not None:
        scenario = scenario.replace({"solver.engine": engine})
    begin = time.perf_counter()
    try:
        (run,) = simulate_many([scenario], record="summary", threads=1)
    except ScenarioError as error:
        return {"end": f"refused: {error.path}"}
    wall, duration = time.perf_counter() - begin, run.metrics["time"]
    return {
        "end": str(run.outcome),
        "mechanism": str(run.mechanism or ""),
        "time": round(duration, 3),
        "x": round(run.metrics["final_x"], 5),
        "y": round(run.metrics["final_y"], 5),
        "angle": round(run.metrics["final_angle"], 5),
        "yaw": 0.0,
        "roll": 0.0,
        "cost": round(wall / duration, 4),
    }
