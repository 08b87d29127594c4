"""The comparison of chains with their substitutes, with a few runs."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from research import steps
from research.__main__ import main
from research.models import study_models
from research.seizure import Sweeps
from research.seizure_tables import Cell
from research.steps import (
    CHAINS_FULL,
    CHAINS_QUICK,
    ChainStep,
    chain_models,
    chain_steps,
    chain_steps_text,
    flipper_robots,
    highest_steps,
    highest_steps_text,
    plot_chains,
)
from tests.shared import ROBOT

MODELS = chain_models()


def test_every_model_has_the_grousers_of_the_robot() -> None:
    for name, model in MODELS.items():
        Scenario(ROBOT.with_track(model.track), c2d.terrains.step(0.05)).validate()
        wheel = getattr(model.track, "wheel", None)
        assert wheel in (None, c2d.GearWheel()), name
    assert CHAINS_FULL.heights["step"][0] == pytest.approx(0.03)
    assert CHAINS_FULL.heights["step"][-1] == pytest.approx(0.16)
    assert CHAINS_FULL.repeats >= 40


def test_every_model_is_simulated_with_the_default_accuracy() -> None:
    models = {name: MODELS[name] for name in ("belt with grousers", "24 gears all round")}
    design = replace(CHAINS_QUICK, heights={"step": (0.03,)}, repeats=1)
    table = Sweeps(design=design, models=models, progress=False).on_obstacle("step")
    assert table["track"].to_numpy().tolist() == list(models)
    for name in models:
        text = table["scenario"].sel(track=name).item()
        assert Scenario.from_json(text).solver == c2d.Solver()


def test_the_picture_has_tracks_on_the_left_and_wheels_beside_the_belt() -> None:
    cells = [
        Cell(
            robot="preset",
            obstacle="step",
            model=name,
            height=height,
            cleared=2,
            count=4,
            rate=0.5,
            low=0.15,
            high=0.85,
            poses=4,
            others="",
        )
        for name in MODELS
        for height in (0.03, 0.04)
    ]
    tracks, wheels = plot_chains(cells).axes
    assert [line.get_label() for line in tracks.lines] == list(MODELS)[:4]
    assert [line.get_label() for line in wheels.lines] == [next(iter(MODELS)), *list(MODELS)[4:]]
    assert "[mm]" in tracks.get_xlabel()
    assert "[%]" in tracks.get_ylabel()


def test_it_writes_its_table_and_its_picture(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    design = replace(CHAINS_QUICK, heights={"step": (0.03,)}, repeats=1)
    monkeypatch.setattr(steps, "CHAINS_QUICK", design)
    assert main(["chains", "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    with (tmp_path / "chains.csv").open(newline="") as file:
        found = list(csv.DictReader(file))
    assert [row["model"] for row in found] == list(MODELS)
    for line in (tmp_path / "chains.txt").read_text(encoding="utf-8").splitlines():
        assert line in printed
    assert (tmp_path / "chains.png").stat().st_size > 10_000


def test_an_accuracy_sets_the_steps_and_keeps_the_pins_as_tight() -> None:
    coarse, fine = chain_steps((0.03,), repeats=1, accuracies=[1e-5, 1e-6])
    assert (coarse.accuracy, fine.accuracy) == (1e-5, 1e-6)
    assert coarse.step > fine.step
    for row in (coarse, fine):
        assert 0.0 < row.flat_gap < 2e-4
        assert abs(row.lowest - 0.064) < 2e-3
        assert row.lowest <= row.highest
        assert np.shape(row.cleared) == (1, 3)


def test_the_table_of_steps_has_its_units() -> None:
    row = ChainStep(
        accuracy=3e-7,
        step=1.2e-4,
        flat_gap=6e-6,
        gap=43e-6,
        lowest=0.064,
        highest=0.06448,
        cleared=((0.5, 0.4, 0.6),),
        cost=0.054,
    )
    head, _, line = chain_steps_text([row], (0.05,)).splitlines()
    assert "gap, flat [um]" in head
    assert "accuracy [um]" in head
    assert line.split()[:4] == ["0.3", "0.12", "6.0", "43"]
    assert "64.00 to 64.48" in line
    assert "0.50 (0.40 to 0.60)" in line
    assert line.split()[-1] == "54"


def test_robots_with_other_flippers_weigh_what_the_preset_makes_them_weigh() -> None:
    arms = c2d.robots.engineer().flippers
    assert arms is not None
    robots = flipper_robots()
    for name, other in (
        ("in front", arms),
        ("behind", replace(arms, ends="rear")),
        ("both ends", replace(arms, ends="both")),
    ):
        assert robots[name] == c2d.robots.engineer(flippers=other).without_rotors()


def test_flippers_at_both_ends_carry_a_belt_over_a_higher_step() -> None:
    belt = {"belt": study_models()["belt"]}
    rows = highest_steps((0.04, 0.24, 0.6), models=belt, repeats=1)
    bare, _, _, both = rows
    assert [row.robot for row in rows] == ["no flippers", "in front", "behind", "both ends"]
    assert (bare.height, both.height) == (0.04, 0.24)
    assert all(row.gaps == 0 and row.paper is None for row in rows)
    assert both.limit not in ("", "cleared", "none up to here")
    head, _, line, note = highest_steps_text(rows).splitlines()
    assert head.split()[-5:] == ["in", "front", "behind", "both", "ends"]
    assert line.startswith("belt")
    assert note.startswith("* fewer than half")
