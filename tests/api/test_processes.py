"""Other processes compute the same bits, or raise an error that says why not."""

import multiprocessing
import subprocess
import sys

import numpy as np
import pytest

import crawler2d as c2d


def final_pose(text: str) -> tuple[float, float, float]:
    run = c2d.simulate(c2d.Scenario.from_json(text), record="summary")
    return run.metrics["final_x"], run.metrics["final_y"], run.metrics["final_angle"]


@pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork:DeprecationWarning")
@pytest.mark.parametrize("method", multiprocessing.get_all_start_methods())
def test_every_kind_of_process_finds_the_same_bits(method: str) -> None:
    scenario = c2d.Scenario(
        c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05), duration=2.0
    )
    text = scenario.to_json()
    here = final_pose(text)
    with multiprocessing.get_context(method).Pool(2) as pool:
        assert pool.map_async(final_pose, [text] * 4).get(timeout=60.0) == [here] * 4


def test_a_second_interpreter_gets_an_import_error() -> None:
    program = (
        "import crawler2d\n"
        "import _xxsubinterpreters as sub\n"
        "id = sub.create()\n"
        "try:\n"
        "    sub.run_string(id, 'import crawler2d')\n"
        "except sub.RunFailedError as error:\n"
        "    print(error)\n"
    )
    if sys.version_info >= (3, 13):
        pytest.skip("the module of subinterpreters has another name")
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=60.0, check=False
    )
    assert "ImportError" in done.stdout


EXTREMES = {
    "no gravity": c2d.Scenario(
        c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05), gravity=0.0
    ),
    "ten thousand newton metres": c2d.Scenario(
        c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05)
    ).replace({"robot.drivetrain.max_torque": 1e4}),
    "a step of ten radii": c2d.Scenario(
        c2d.robots.engineer(flippers=None), c2d.terrains.step(0.64)
    ),
    "a slope of 88 degrees": c2d.Scenario(
        c2d.robots.engineer(flippers=None), c2d.terrains.ramp(np.radians(88.0), length=0.05)
    ),
    "a post of a millimetre": c2d.Scenario(
        c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(3)),
        c2d.terrains.from_points(
            [(-2, 0), (0, 0), (0, 0.04), (0.001, 0.04), (0.001, 0), (2, 0)], goal=0.001
        ),
    ),
    "no friction": c2d.Scenario(
        c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05, friction=0.0)
    ),
    "friction of three": c2d.Scenario(
        c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05, friction=3.0)
    ),
    "on its nose": c2d.Scenario(
        c2d.robots.engineer(flippers=None), c2d.terrains.flat(), start=c2d.Start(angle=-1.5)
    ),
}


@pytest.mark.parametrize("name", EXTREMES)
def test_extreme_valid_scenarios_run_and_stay_finite(name: str) -> None:
    run = c2d.simulate(EXTREMES[name].replace({"duration": 3.0}))
    for column in (run.position, run.velocity, run.chassis_angle, run.drive_force):
        assert np.isfinite(column).all()
    assert run.metrics["max_penetration"] < 0.005
