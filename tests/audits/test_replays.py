"""The run that the page of an audit replays, and its description."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.audits import page
from crawler2d.audits.page import (
    Replay,
    _closest,
    _diagnosis,
    _drawn,
    _options,
    _replay_section,
    _seizure,
)
from crawler2d.audits.record import AuditRecord
from crawler2d.audits.verdicts import BELT, OWN, ObstacleRuns
from tests.audits.made import made_of_file, made_of_robot


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> AuditRecord:
    return made_of_file(tmp_path_factory.mktemp("made"))


@pytest.mark.parametrize("number", [0, 1, 2, 5])
def test_the_first_of_the_fastest_runs_that_are_jammed_where_most_are_is_replayed(
    made: AuditRecord, number: int
) -> None:
    verdict = made.verdicts[number]
    own, belt = (ObstacleRuns(made.table, model, verdict.obstacle) for model in (OWN, BELT))
    found = _seizure(made, verdict)
    places = [
        (sample, repeat)
        for sample, repeat in np.ndindex(own.ends.shape)
        if own.ends[sample, repeat] == "seized"
        and own.column("stop_bodies")[sample, repeat] == verdict.jam_wheels
    ]
    cleared = [place for place in places if belt.ends[place] == "cleared"]
    chosen = cleared or places
    fastest = max(own.speeds[place] for place in chosen)
    first = next(place for place in chosen if own.speeds[place] == fastest)
    assert (found.sample, found.repeat) == first
    assert found.other == "the belt"
    assert found.value(made, "stop_bodies") == verdict.jam_wheels


def test_a_run_that_the_belt_clears_is_preferred_to_a_faster_one(made: AuditRecord) -> None:
    verdict = made.verdicts[0]
    alone = made.table.copy(deep=True)
    ends = alone["outcome"].sel(model=BELT, terrain=verdict.obstacle)
    ends[:] = "slipping"
    ends[4, 0] = "cleared"
    audit = replace(made, table=alone)
    own = ObstacleRuns(alone, OWN, verdict.obstacle)
    assert own.column("stop_bodies")[4, 0] == verdict.jam_wheels
    assert own.speeds[4, 0] < own.speeds.max()
    assert (_seizure(audit, verdict).sample, _seizure(audit, verdict).repeat) == (4, 0)


def test_of_a_robot_that_never_seizes_the_slowest_failure_is_replayed(made: AuditRecord) -> None:
    (found,) = _closest(made)
    lengths = {}
    for verdict in made.verdicts:
        own, belt = (ObstacleRuns(made.table, each, verdict.obstacle) for each in (OWN, BELT))
        for place in np.ndindex(own.ends.shape):
            if own.ends[place] != "cleared" and belt.ends[place] == "cleared":
                at = verdict.obstacle, *place
                lengths[at] = own.speeds[place] * own.column("time")[place]
    assert (found.verdict.obstacle, found.sample, found.repeat) == max(
        lengths, key=lambda each: lengths[each]
    )
    nowhere = made_of_robot()
    assert len(_closest(nowhere)) == 1
    assert _closest(replace(nowhere, table=nowhere.table.drop_vars("time"))) == []


def test_what_was_drawn_for_a_run_is_said_with_its_unit(made: AuditRecord) -> None:
    whole = made.table
    dims = whole["outcome"].dims
    for name, path, value in (
        ("drawn_speed", "drive.speed", 0.123456),
        ("drawn_seed", "terrain.seed", 7.0),
        ("drawn_height", "terrain.height", np.nan),
    ):
        numbers = np.full(whole["outcome"].shape, value)
        whole = whole.assign({name: (dims, numbers, {"path": path})})
    replay = Replay(made.verdicts[0], 3, 1, [])
    assert _drawn(replace(made, table=whole), replay) == [
        "terrain: friction 0.535",
        "drive: speed 0.1235 m/s",
        "terrain: seed 7",
    ]


def run(outcome: c2d.Outcome, reason: str) -> Any:
    return SimpleNamespace(outcome=outcome, reason=reason)


def test_the_text_of_a_replay_says_why_it_stopped_and_where_others_do(made: AuditRecord) -> None:
    seized, cleared = made.verdicts[0], made.verdicts[3]
    why = "it jams. Tried: torque x 2, which does not free it"
    stopped = run(c2d.Outcome.SEIZED, why)
    draws = "Its random values: terrain: friction 0.535."
    fold = "<details><summary>what was tried, and details of this run</summary>"
    belt = run(c2d.Outcome.CLEARED, "")
    assert _diagnosis(made, Replay(seized, 3, 1, [stopped, belt])) == (
        f'<p class="diagnosis">It jams.</p>{fold}'
        "<p>Tried at the stop: torque x 2, which does not free it.</p>"
        "<p>Sample 3, repeat 1 of the runs, counted from 0; 44 of 60 seizures on this obstacle are"
        f" there. {draws}</p></details>"
    )
    both = _diagnosis(made, Replay(seized, 3, 1, [stopped, stopped]))
    assert "It jams. In this run the other robot seizes, too.</p>" in both
    known = replace(made, table=made.table.drop_vars("unknown_friction"))
    assert _diagnosis(known, Replay(cleared, 0, 0, [belt])) == (
        '<p class="diagnosis">It seized in no run; this is the one that came closest. It'
        f" clears.</p>{fold}<p>Sample 0, repeat 0 of the runs, counted from 0. Its random values:"
        " none.</p></details>"
    )


def test_the_first_replay_alone_is_shown_at_first(
    made: AuditRecord, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(page, "pair_figure", lambda name, run: f"<i>{name}: {run.outcome}</i>")
    belt = run(c2d.Outcome.CLEARED, "")
    replay = Replay(made.verdicts[0], 3, 1, [run(c2d.Outcome.SEIZED, "it jams"), belt], "a repair")
    text = (
        '<div class="pair"><i>the model: seized</i><i>a repair: cleared</i></div>'
        f"{_diagnosis(made, replay)}</div>"
    )
    assert _replay_section(made, replay, 0) == f'<div class="runs" id="replay-0">{text}'
    assert _replay_section(made, replay, 2) == f'<div class="runs" id="replay-2" hidden>{text}'


def test_an_obstacle_on_which_it_seizes_by_the_rule_is_replayed_first(
    made: AuditRecord, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Then the others, by rate of seizing; all next to the best repair, if there is one."""
    step, gap, stairs, kerb, _, knife = made.verdicts
    often = replace(stairs, seized=replace(stairs.seized, rate=0.99))
    asked: dict[str, Any] = {}

    def simulate(scenarios: list[Any], **how: Any) -> list[Any]:
        asked.update(how, scenarios=scenarios)
        return scenarios

    monkeypatch.setattr(page, "simulate_many", simulate)
    monkeypatch.setattr(page, "_scenarios", lambda _, each: [each.verdict.obstacle, each.other])
    audit = replace(made, verdicts=(knife, often, kerb, gap, step))
    found = page.simulate_replays(audit, threads=3)
    names = [step.obstacle, gap.obstacle, stairs.obstacle, knife.obstacle]
    assert [each.verdict.obstacle for each in found] == names
    repair = "chassis: 5 wheels in place of 4 (confirmed)"
    assert asked["scenarios"] == [part for name in names for part in (name, repair)]
    assert all(len(each.runs) == 2 for each in found)
    assert asked["threads"] == 3
    assert asked["on_error"] == "record"
    assert asked["trials"] == ("torque x 2", "friction x 2")
    bare = page.simulate_replays(replace(audit, repaired=None))
    assert {each.other for each in bare} == {"the belt"}
    none = page.simulate_replays(replace(made, verdicts=(kerb,), repaired=None))
    assert [each.verdict.obstacle for each in none] == ["kerb"]


def test_the_other_robot_drives_with_its_tracks_alone(made: AuditRecord) -> None:
    """Everything else is as drawn for the run."""
    own = c2d.Scenario(made.robot, c2d.terrains.step(0.07)).replace({"robot.mass": 17.5})
    table = made.table.assign(scenario=made.table["outcome"].astype(object))
    table["scenario"][:] = own.to_json()
    audit = replace(made, table=table)
    replay = Replay(made.verdicts[0], 3, 1, [])
    first, other = page._scenarios(audit, replay)
    assert first == own
    repair = made.repairs[0].robot
    changed = {
        "robot.track": repair.track,
        "robot.drivetrain.torque_sharing": repair.drivetrain.torque_sharing,
    }
    assert other == own.replace(changed)
    belt = made.belt.robot
    (_, belted) = page._scenarios(replace(audit, repaired=None), replay)
    assert belted.robot.track == belt.track
    assert belted.robot.drivetrain.torque_sharing == belt.drivetrain.torque_sharing == "track"
    same = replace(audit, repaired=None, belt=made.belt._replace(robot=made.robot))
    assert page._scenarios(same, replay) == [own]


def test_every_replay_is_an_option_with_its_rate(made: AuditRecord) -> None:
    replays = [Replay(made.verdicts[number], 0, 0, []) for number in (0, 4)]
    assert _options(replays) == (
        '<option value="0">step of 75 mm: 75 % seized</option>'
        '<option value="1">&lt;ramp&gt; &amp; more: 0 % seized</option>'
    )
