"""Checks and searches of an audit with made-up runs: which runs are made, and what is chosen."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import xarray as xr

import crawler2d as c2d
from crawler2d.audits import repairs, sampling
from crawler2d.audits.candidates import Candidate
from crawler2d.audits.runs import RunCounter, belt_of
from crawler2d.audits.verdicts import BELT, OWN, verdict_of
from crawler2d.variation.distributions import Ranges
from tests.audits.seizing import SEIZING

STEP = c2d.terrains.step(0.075)
COUNT = RunCounter(None, 1)


def table_of(ends: Mapping[str, list[str]], name: str = "step", **columns: Any) -> xr.Dataset:
    """Runs of one obstacle at one speed, one for each sample."""
    outcomes = np.array([[[[end] for end in each]] for each in ends.values()])
    dims = ("model", "terrain", "sample", "repeat")
    filled = {key: (dims, np.full(outcomes.shape, value)) for key, value in columns.items()}
    speeds = (("sample", "repeat"), np.full(outcomes.shape[2:], 0.4))
    usual = {"stop_bodies": (dims, np.full(outcomes.shape, "1-2"))}
    usual["stop_carrier"] = (dims, np.full(outcomes.shape, "chassis"))
    at = {"model": list(ends), "terrain": [name], "speed": speeds}
    return xr.Dataset({"outcome": (dims, outcomes), **usual, **filled}, at)


@dataclass
class Course:
    """Runs whose ends are given in advance."""

    ends: dict[str, list[str]]
    driven: list[tuple[str, int]] = field(default_factory=list)

    @property
    def samples(self) -> int:
        return len(self.ends[OWN])

    def drive(self, robot: str, samples: int, progress: Any = None) -> None:
        assert progress is not None
        self.driven.append((robot, samples))

    def table(self) -> xr.Dataset:
        made = {name: dict(self.driven).get(name, 0) for name in self.ends}
        return table_of(
            {
                name: [end if k < made[name] else "" for k, end in enumerate(each)]
                for name, each in self.ends.items()
            }
        )


def driven(own: list[str], belt: list[str]) -> tuple[list[tuple[str, int]], str]:
    """Return the runs made until a verdict is certain, and the verdict."""
    course: Any = Course({OWN: own, BELT: belt})
    verdict, _ = sampling.verdict_on(course, "step", COUNT)
    return course.driven, verdict.result


def test_samples_are_made_nine_by_nine_until_the_verdict_is_certain() -> None:
    cleared, seized = ["cleared"] * 40, ["seized"] * 40
    looks = (9, 18, 27, 36, 40)
    assert driven(cleared, cleared) == ([(OWN, k) for k in looks], "does not seize")
    assert driven(seized, cleared) == ([(OWN, 9), (BELT, 9)], "seizes")
    both = [(robot, k) for k in looks for robot in (OWN, BELT)]
    hung = ["hung_up"] * 40
    assert driven(hung, cleared) == (both, "does not seize")
    # Both fail in so many of a quarter of the runs that neither can reach 95 % any longer.
    assert driven(hung, hung) == (both[:4], "belt fails, too")


def test_the_belt_drives_as_soon_as_the_robot_seizes_or_clears_less_than_95_percent() -> None:
    cleared = ["cleared"] * 40
    late = [*["cleared"] * 20, "seized", *["cleared"] * 19]
    found, _ = driven(late, cleared)
    assert found[:4] == [(OWN, 9), (OWN, 18), (OWN, 27), (BELT, 27)]
    assert found[4:] == [(OWN, 36), (BELT, 36), (OWN, 40), (BELT, 40)]
    few = [*["cleared"] * 39, "slipping"]  # 97.5 %
    assert BELT not in dict(driven(few, cleared)[0])
    more = [*["cleared"] * 37, *["slipping"] * 3]  # 92.5 %
    assert driven(more, cleared)[0][-1] == (BELT, 40)


@dataclass
class MadeRuns:
    """Records requests for runs, and returns given ones."""

    course_of: Any
    unknown: Mapping[str, Any] = field(default_factory=dict)
    repeats: int = 3
    trials: tuple[str, ...] = ("torque x 2",)

    def course(self, robots: Mapping[str, c2d.Robot], name: str, ground: Any) -> Any:
        return self.course_of(self, robots, name, ground)


@pytest.mark.parametrize(("samples", "made"), [(40, 18), (12, 12)])
def test_an_assumption_is_driven_with_eighteen_samples(samples: int, made: int) -> None:
    asked: list[Any] = []
    ends = ["seized", "cleared", "slipping", "diverged"] * (samples // 4)

    def course_of(*given: Any) -> Course:
        course = Course({OWN: ends})
        asked.append((given, course))
        return course

    gain = replace(SEIZING.drivetrain, controller=c2d.PI(gain=5.0))
    robot = replace(SEIZING, drivetrain=gain)
    rotor = Ranges({"robot.drivetrain.rotor_inertia": c2d.uniform(0.01, 0.1)})
    impacts = Ranges({"solver.restitution": c2d.uniform(0.0, 1.0)})
    known = {"robot.mass": c2d.uniform(5.0, 6.0)}
    runs: Any = MadeRuns(course_of, known)
    found = sampling.check_assumptions(
        {"rotor": rotor, "restitution": impacts}, runs, robot, ("step", STEP), COUNT
    )
    assert [each.assumption for each in found] == ["rotor", "restitution"]
    for each, ranges, (given, course) in zip(found, (rotor, impacts), asked, strict=True):
        how, robots, name, ground = given
        assert dict(how.unknown) == {**known, **ranges}
        assert (how.repeats, how.trials, name, ground) == (1, (), "step", STEP)
        without = replace(robot, drivetrain=replace(gain, controller=None))
        assert robots == {OWN: without if each.assumption == "rotor" else robot}
        assert course.driven == [(OWN, made)]
        assert (each.obstacle, each.drawn) == ("step", ranges)
        of_all = ends[:made]
        assert each.seized == of_all.count("seized")
        assert each.runs == made - of_all.count("diverged")


def test_an_assumption_holds_where_the_lower_bound_of_its_rate_is_above_5_percent() -> None:
    assert [c2d.wilson(hits, 18).low > 0.05 for hits in (2, 3)] == [False, True]


# The search for a repair


def candidates(count: int) -> list[Candidate]:
    return [
        Candidate(
            description=f"{k} wheels",
            kind="wheels",
            robot=SEIZING.with_track(c2d.LineOfWheels(k + 5, wheel_radius=0.06)),
            change=k,
        )
        for k in range(count)
    ]


def best_of(
    monkeypatch: pytest.MonkeyPatch,
    fails: dict[int, int],
    *,
    count: int = 9,
    free: tuple[int, ...] = (),
    seized: int = 40,
    is_quick: bool = False,
) -> tuple[int, list[int]]:
    """Return the chosen candidate, and the runs of each round; some fail in the first runs."""
    sizes: list[int] = []
    seen: dict[int, int] = {}
    number = {each.robot.track: k for k, each in enumerate(candidates(count))}

    def simulate(scenarios: list[c2d.Scenario], **how: Any) -> list[Any]:
        assert (how["record"], how["trials"], how["threads"]) == ("summary", None, 2)
        sizes.append(len(scenarios))
        runs = []
        for each in scenarios:
            k = number[each.robot.track]
            seen[k] = seen.get(k, 0) + 1
            is_bad = seen[k] <= fails.get(k, 0)
            runs.append(SimpleNamespace(outcome="hung_up" if is_bad else c2d.Outcome.CLEARED))
        return runs

    monkeypatch.setattr(repairs, "simulate_many", simulate)
    monkeypatch.setattr(repairs, "free_of_jams", lambda *_: list(free))
    text = c2d.Scenario(SEIZING, STEP).to_json()
    table = table_of({OWN: ["seized"] * seized, BELT: ["cleared"] * seized}, scenario=text)
    space = candidates(count)
    chosen = repairs._best_of(space, table, ["step"], is_quick=is_quick, threads=2, show=None)
    return space.index(chosen), sizes


def test_the_better_half_of_the_candidates_goes_on_until_two_are_left(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """3 runs of 9, 3 more of 5, 6 more of 3, 12 more of 2."""
    assert best_of(monkeypatch, {}) == (0, [27, 15, 18, 24])
    assert best_of(monkeypatch, {}, is_quick=True) == (0, [9, 10, 9, 12])
    assert best_of(monkeypatch, {}, count=2) == (0, [6, 6, 12, 24])
    assert best_of(monkeypatch, {}, seized=8) == (0, [27, 15, 6, 0])


def test_the_least_changed_candidate_that_clears_95_percent_is_chosen(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    none_but = dict.fromkeys(range(9), 3)
    assert best_of(monkeypatch, {**none_but, 4: 0, 6: 0})[0] == 4
    # One of 24 is 96 %, and less change counts; two are 92 %.
    assert best_of(monkeypatch, {**none_but, 4: 1, 6: 0})[0] == 4
    assert best_of(monkeypatch, {**none_but, 4: 2, 6: 0})[0] == 6
    assert best_of(monkeypatch, {**none_but, 5: 2, 7: 2})[0] == 5


def test_candidates_that_can_jam_by_computation_are_not_driven(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert best_of(monkeypatch, {}, free=(3, 7)) == (3, [6, 6, 12, 24])


def test_runs_in_which_it_seized_are_taken_from_every_obstacle_in_turn() -> None:
    def texts(name: str, mass: float, ends: list[str], belts: list[str]) -> xr.Dataset:
        found = table_of({OWN: ends, BELT: belts}, name, scenario=" " * 4000)
        for sample in range(len(ends)):
            robot = replace(SEIZING, mass=mass + sample)
            found["scenario"][0, 0, sample, 0] = c2d.Scenario(robot, STEP).to_json()
        return found

    one = texts("one", 10.0, ["seized", "cleared", "seized", "seized"], ["cleared"] * 4)
    other = texts("other", 20.0, ["seized"] * 4, ["hung_up", "cleared", "hung_up", "hung_up"])
    table = xr.concat([one, other], "terrain")
    found = repairs._seized(table, ["one", "other"])
    assert [each.robot.mass for each in found] == [10.0, 21.0, 12.0, 13.0]
    assert [each.robot.mass for each in repairs._seized(table, ["other"])] == [21.0]


def failing(own: list[str], belt: list[str], *, seizing: bool = True) -> bool:
    tables = {"step": table_of({"five": own, OWN: belt})}
    return repairs._fails(tables, "five", OWN, ["step"] if seizing else [])


@pytest.mark.parametrize(
    ("own", "belt", "of_seizing", "of_others"),
    [
        ({"cleared": 40}, {"cleared": 40}, False, False),
        ({"hung_up": 2, "cleared": 38}, {"cleared": 40}, False, False),
        ({"hung_up": 3, "cleared": 37}, {"cleared": 40}, True, False),
        ({"hung_up": 3, "": 37}, {"cleared": 40}, True, False),
        ({"hung_up": 3, "cleared": 37}, {"hung_up": 3, "cleared": 37}, False, False),
        ({"diverged": 3, "cleared": 37}, {"cleared": 40}, False, False),
        ({"seized": 2, "cleared": 38}, {"hung_up": 40}, False, False),
        ({"seized": 3, "cleared": 37}, {"hung_up": 40}, True, True),
        ({"seized": 3, "": 37}, {"": 40}, True, True),
    ],
)
def test_a_candidate_fails_as_soon_as_no_run_can_confirm_it(
    own: dict[str, int], belt: dict[str, int], of_seizing: bool, of_others: bool
) -> None:
    ours, theirs = (
        list(itertools.chain.from_iterable([end] * count for end, count in each.items()))
        for each in (own, belt)
    )
    assert failing(ours, theirs) is of_seizing
    assert failing(ours, theirs, seizing=False) is of_others


def test_level_ground_has_no_draws_of_what_obstacles_have() -> None:
    height, friction = c2d.scaled(0.9, 1.1), c2d.uniform(0.5, 1.0)
    draws = {"terrain.height": height, "terrain.friction": friction, "robot.mass": friction}
    assert list(repairs._on_level(draws)) == ["terrain.friction", "robot.mass"]
    length = {"terrain.length": height}
    assert dict(repairs._on_level(length)) == length
    # One unknown stays, or the samples would be repeats.
    alone = repairs._on_level({"terrain.height": height})
    assert dict(alone) == {"terrain.friction": c2d.scaled(1.0, 1.0)}
    assert dict(repairs._on_level({})) == {}


def test_the_speed_of_a_simulation_is_that_of_its_fastest_run() -> None:
    table = table_of({"five": ["cleared"] * 3}, repairs.LEVEL, time=2.0, wall_time=1.0)
    table["wall_time"][0, 0, :, 0] = [0.5, 0.1, np.nan]
    assert repairs._speed(table, "five") == 20.0


def test_confirmed_repairs_come_first_and_of_these_the_smallest_change(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    wheels, more_wheels, gears = (
        replace(each, kind=kind, change=change)
        for each, kind, change in zip(
            candidates(3), ("wheels", "wheels", "gears"), (6, 7, 1), strict=True
        )
    )
    belt = belt_of(SEIZING)
    belts = f"belts moved by a track plugin ({belt.reason})"  # of 4 wheels: a change of 5
    cleared, seized = ["cleared"] * 40, ["seized"] * 40
    ends = {OWN: seized, wheels.description: cleared, gears.description: seized, belts: cleared}
    times = {"time": 2.0, "wall_time": 1.0}
    over = [table_of(ends, name, **times) for name in ("step", repairs.LEVEL)]
    monkeypatch.setattr(repairs, "candidates_of", lambda *_: [wheels, more_wheels, gears])
    monkeypatch.setattr(repairs, "_best_of", lambda space, *_, **__: space[0])
    monkeypatch.setattr(repairs, "_drive", lambda *_, **__: xr.concat(over, "terrain"))
    verdict = verdict_of(table_of({OWN: seized, BELT: cleared}), "step")
    runs: Any = SimpleNamespace(threads=1)
    found = repairs.search_repairs(
        SEIZING,
        belt,
        grounds={"step": STEP},
        verdicts=[verdict],
        table=over[0],
        runs=runs,
        is_quick=False,
        show=None,
    )
    told = [(each.kind, each.change, each.confirmed) for each in found.repairs]
    assert told == [("belt", 5, True), ("wheels", 6, True), ("gears", 1, False)]
    assert found.candidate_count == 4
