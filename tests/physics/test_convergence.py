"""Success rates do not change if the solver is ten times as accurate.

Cells have rates between 5 and 95 %, where robots only just clear and any error of the
discretisation shifts the rate. `make soak` runs all of them.
"""

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.parameters.track import Track
from crawler2d.sweeps.statistics import newcombe

RUNS = 400

GEAR = c2d.GearWheel()

# Track model, friction, height of the step [m].
CELLS: list[tuple[Track, float, float]] = [
    (c2d.LineOfWheels(3), 0.6, 0.049),
    (c2d.LineOfWheels(3), 0.6, 0.050),
    (c2d.LineOfWheels(3), 0.9, 0.106),
    (c2d.LineOfWheels(4, wheel_radius=0.365 / 6), 0.6, 0.050),
    (c2d.LineOfWheels(4, wheel_radius=0.365 / 6), 0.9, 0.071),
    (c2d.LineOfWheels(5), 0.6, 0.052),
    (c2d.LineOfWheels(5), 0.6, 0.053),
    (c2d.LineOfWheels(9), 0.6, 0.052),
    (c2d.LineOfWheels(9), 0.6, 0.053),
    (c2d.LineOfWheels(9), 0.9, 0.104),
    (c2d.BeltTrack(), 0.6, 0.052),
    (c2d.BeltTrack(), 0.6, 0.053),
    (c2d.LineOfWheels(3, wheel=GEAR), 0.9, 0.110),
    (c2d.LineOfWheels(3, wheel=GEAR), 0.9, 0.120),
    (c2d.LineOfWheels(5, wheel=GEAR), 0.9, 0.090),
    (c2d.LineOfWheels(5, wheel=GEAR), 0.9, 0.110),
    (c2d.CircumferentialWheels(24, wheel=GEAR), 0.6, 0.050),
    (c2d.GrouserBeltTrack(), 0.9, 0.080),
    (c2d.GrouserBeltTrack(), 0.9, 0.090),
]

# The same with arms in front: higher than any robot gets without them.
ON_ARMS: list[tuple[Track, float, float]] = [
    (c2d.BeltTrack(), 0.6, 0.105),
    (c2d.BeltTrack(), 0.9, 0.115),
]


def ensemble(track: Track, friction: float, height: float, solver: c2d.Solver) -> list[c2d.Run]:
    """Runs with the same draws of approach, phase, speed and friction for every solver."""
    has_arms = (track, friction, height) in ON_ARMS
    robot = c2d.robots.engineer(flippers="built" if has_arms else None, track=track)
    robot = robot.without_rotors()  # with which rates are different
    gait = c2d.Climb() if has_arms else None
    scenarios = []
    for repeat in range(RUNS):
        draw = np.random.default_rng([0, repeat]).random(4)
        scenarios.append(
            c2d.Scenario(
                robot=robot,
                terrain=c2d.terrains.step(height, friction=friction * (0.98 + 0.04 * draw[3])),
                drive=c2d.Drive(speed=0.4 * (0.98 + 0.04 * draw[2]), gait=gait),
                start=c2d.Start(approach=0.05 + 0.1 * draw[0], track_phase=0.048 * draw[1]),
                duration=12.0,
                solver=solver,
            )
        )
    return c2d.simulate_many(scenarios, record="summary")


@pytest.mark.soak
def test_rates_and_poses_do_not_move_at_a_tenth_of_the_accuracy() -> None:
    # By chance, one of them leaves its interval in one of twenty such tests.
    cells = CELLS + ON_ARMS
    confidence = 1.0 - 0.05 / len(cells)
    default = c2d.Solver()
    assert default.accuracy is not None
    finer = c2d.Solver(accuracy=0.1 * default.accuracy)
    shifts, holds = [], []
    for track, friction, height in cells:
        base, runs = (ensemble(track, friction, height, solver) for solver in (default, finer))
        cleared, again = (sum(run.outcome == "cleared" for run in own) for own in (base, runs))
        shift, low, high = newcombe(again, RUNS, cleared, RUNS, confidence)
        apart = [
            np.hypot(
                a.metrics["final_x"] - b.metrics["final_x"],
                a.metrics["final_y"] - b.metrics["final_y"],
            )
            for a, b in zip(base, runs, strict=True)
            if a.outcome == b.outcome and a.outcome is not None and a.outcome.is_stop
        ]
        print(
            f"{track} friction {friction} step {height}: rate {cleared / RUNS:.3f}; "
            f"{shift:+.3f} [{low:+.3f}, {high:+.3f}], "
            f"stopped poses within {1e3 * max(apart, default=0.0):.2f} mm"
        )
        shifts.append(shift)
        holds.append(abs(shift) < 0.05 or low <= 0.0 <= high)
        # Grousers keep a stopped robot moving to and fro.
        has_grousers = isinstance(track, c2d.GrouserBeltTrack) or (
            getattr(getattr(track, "wheel", None), "kind", "") == "gear"
        )
        assert has_grousers or max(apart, default=0.0) < 1e-3
    print(f"pooled {np.mean(shifts):+.4f}")
    assert all(holds)
    assert abs(np.mean(shifts)) <= 0.02
