"""benches/peers: the chain is the same robot in both engines and closed, with correct gaps."""

import importlib
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benches.adapters.planar import Setting
from benches.peers import chains, report
from benches.peers.chains import TEETH, ChainRobot
from crawler2d.runs.simulation import Simulation
from research.tables import splice

STEP = np.array([(-5.0, 0.0), (0.8, 0.0), (0.8, 0.15), (15.0, 0.15)])
every_chain = pytest.mark.parametrize("count", TEETH)


@every_chain
def test_the_chain_closes_round_both_ends(count: int) -> None:
    robot = ChainRobot(count)
    pins = robot.pins()
    spans = np.hypot(*(np.roll(pins, -1, axis=0) - pins).T)
    assert len(pins) == count
    assert spans == pytest.approx(robot.pitch)
    # Each shoe begins where the last ends: once round, counter-clockwise.
    angles = robot.shoes()[:, 2]
    turns = np.remainder(np.diff(angles, append=angles[0]) + 1e-9, 2.0 * np.pi)
    assert turns.sum() == pytest.approx(2.0 * np.pi)
    assert turns.max() < 2.1 * np.pi / robot.tooth_count


@every_chain
def test_teeth_stand_between_lugs_and_below_the_plates(count: int) -> None:
    robot = ChainRobot(count)
    for tooth in robot.teeth():
        assert np.hypot(*tooth.T).max() < robot.disc_radius() + chains.DROP
    # A lug and a tooth share a pitch at the tip of the lug.
    reach = robot.pin_radius * np.cos(np.pi / robot.tooth_count) - robot.lug()[:, 1].max()
    room = 2.0 * np.pi * reach / robot.tooth_count
    assert np.ptp(robot.lug()[:, 0]) + np.ptp(robot.teeth()[0][:, 0]) < room


@every_chain
def test_crawler2d_has_the_same_robot(count: int) -> None:
    robot = ChainRobot(count)
    scenario = chains.chain_scenario(robot, STEP, Setting(accuracy=1e-6), 1.0, 0.0)
    built = scenario.robot
    assert built.mass == pytest.approx(19.96)
    assert built.track_mass == pytest.approx(robot.shoe_mass * count)
    # Both sprockets together pull like the single motor at the pins.
    assert 2.0 * built.drivetrain.max_torque == chains.TORQUE
    state = Simulation(scenario).state()
    # A corner of the polygon may stand below the outline at first.
    assert state.position == pytest.approx((0.0, robot.radius), abs=0.05 * robot.radius)
    # The teeth count shoes of the commanded speed.
    passed = -robot.sprocket_speed / (2.0 * np.pi) * robot.tooth_count * robot.pitch
    assert passed == pytest.approx(scenario.drive.speed)


def test_a_gap_is_the_distance_of_two_ends() -> None:
    robot = ChainRobot(36)
    shoes = robot.shoes()
    assert chains.pin_gap(shoes, robot.pitch) < 1e-12
    shoes[7, 0] += 3e-4
    assert chains.pin_gap(shoes, robot.pitch) == pytest.approx(3e-4)


def test_pymunks_chain_runs_and_stays_on() -> None:
    pytest.importorskip("pymunk")
    place = chains.Place(ChainRobot(22), "flat")
    run = chains.ride("pymunk", place, chains.SETTINGS["pymunk, defaults"])
    assert run.survived
    assert abs(run.speed_error) < 0.02
    early = chains.ride("pymunk", place, chains.SETTINGS["pymunk, defaults"], most=1e-6)
    assert len(early.path) < len(run.path)


MACHINE = {
    "date": "2000-01-01",
    "processor": "one",
    "cores": 2,
    "load": 0.0,
    "system": "any",
    "python": "3",
    "versions": {"pymunk": "7"},
}


def test_the_page_has_a_place_for_each_part_of_the_report() -> None:
    page = (Path(__file__).parents[2] / "docs" / "studies" / "peers.md").read_text("utf-8")
    zeros = dict.fromkeys(("spread", "final_x", "penetration", "gap"), 0.0)
    limit = {"is_chaotic": False, "cleared": 1, "count": 1, **zeros}
    step: dict[str, Any] = {"scene": "lwa5-round-step", "limit": limit, "setting": "1 ms"}
    tried = [{"distance": 0.0}]
    rows = [
        {**step, "engine": "pymunk", "found": {"a": 1}, "per_second": 2e-3, "tried": tried},
        {**step, "engine": "MuJoCo", "found": None, "per_second": None, "tried": tried},
    ]
    assert report.speeds(rows) == {"lwa5-round-step": {"pymunk": 500.0}}
    parts = report.render({"machine": MACHINE, "wall": 60.0, "accuracy": rows})
    assert "| lwa5-round-step | 500x |  | none |  |  |" in parts["speeds"]
    assert all(parts[name] in splice(page, parts) for name in ("measured", "speeds"))


def test_the_report_says_which_aims_are_met() -> None:
    cell: dict[str, Any] = {"shoes": 22, "terrain": "flat", "gap": 5e-6}
    judged = {
        "survived": 3,
        "count": 3,
        "distance_gone": 3.16,
        "speed_error": -0.004,
        "distance": 0.003,
    }
    equal = {
        "per_second": {"allowed": 0.1, "crawler2d": 0.05},
        "found": {"allowed": "1 ms, 20 iterations"},
        "finest": ("0.125 ms, 160 iterations", 2e-5),
    }
    parts = report.chain_parts(
        {
            "machine": MACHINE,
            "wall": 60.0,
            "side_by_side": [
                {**cell, **judged, "engine": "crawler2d", "per_second": 3e-2},
                {**cell, **judged, "engine": "pymunk, defaults", "per_second": 2e-2, "gap": 1e-3},
            ],
            "equal_gaps": [{**cell, **equal, "allowed": 2e-4}],
            "engineer": [{"track": "22 shoes", "terrain": "flat", "per_second": 4e-2}],
        }
    )
    text = "\n".join(parts.values())
    assert "**30.0 ms**<br>0.005 mm, 3/3<br>3.16 m, -0.4 %<br>3 mm off" in text
    assert "1 ms, 20 iterations<br>100.0 ms, **2 times**" in text
    assert "none in the grid: 0.02 mm at 0.125 ms, 160 iterations" in text
    assert "| 22 shoes | 40.0 | 50, better 35 | yes |" in text
    assert "costs 1.5 to 1.5 times as much; its pins open 200 to 200 times less" in text


@pytest.mark.parametrize("kept", [None, {"machine": {}}, {"wall": 1.0}])
@pytest.mark.parametrize("given", [["--sections", "chains"], ["--render"]])
def test_an_incomplete_run_is_refused_before_anything_is_measured(
    given: list[str],
    kept: dict[str, Any] | None,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    program = importlib.import_module("benches.peers.__main__")
    result = tmp_path / "peers.json"
    if kept is not None:
        result.write_text(json.dumps(kept))
    monkeypatch.setattr(program, "_RESULT", result)
    monkeypatch.setattr(sys, "argv", ["peers", *given])
    monkeypatch.setattr(program, "measure_chains", lambda *_: pytest.fail("it measures"))
    with pytest.raises(SystemExit):
        program.main()
    assert "must hold a whole run" in capsys.readouterr().err
