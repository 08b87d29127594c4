"""An obstacle is left early only if that changes no verdict, and intervals keep their coverage."""

from __future__ import annotations

from math import comb

import numpy as np
import pytest
import xarray as xr

from crawler2d.audits.sampling import look_counts
from crawler2d.audits.verdicts import BELT, OWN, Verdict, is_certain, verdict_of
from crawler2d.sweeps.statistics import wilson


def part_of(own: list[str], belt: list[str], samples: int, levels: int = 1) -> xr.Dataset:
    """Runs over one obstacle, of which only the first are finished."""
    ends = np.array([[each + [""] * (samples - len(each))] for each in (own, belt)])[..., None]
    dims = ("model", "terrain", "sample", "repeat")
    text = (dims, np.where(ends == "seized", "1-2", ""))
    speeds = np.resize([0.04, 0.13, 0.4][:levels], samples)[:, None]
    tried = {
        f"{what}_{name}": (dims, np.zeros(ends.shape, dtype=bool))
        for what in ("tried", "freed_by")
        for name in ("closed_track", "closed_track_clear_of_the_ground")
    }
    columns = {"outcome": (dims, ends), "stop_carrier": text, "stop_bodies": text, **tried}
    labels = {"model": [OWN, BELT], "terrain": ["step"], "speed": (("sample", "repeat"), speeds)}
    return xr.Dataset(columns, labels)


def seen(seized: int, made: int, samples: int) -> tuple[Verdict, bool]:
    """Judge runs of which some seized while the belt cleared all."""
    own = ["seized"] * seized + ["cleared"] * (made - seized)
    table = part_of(own, ["cleared"] * made, samples)
    verdict = verdict_of(table, "step")
    return verdict, is_certain(table, verdict)


@pytest.mark.parametrize("samples", [36, pytest.param(80, marks=pytest.mark.soak)])
def test_intervals_cover_the_rate_as_often_as_those_of_all_runs(samples: int) -> None:
    """Exactly, over all possible outcomes: the fraction of checks whose interval contains it.

    And it is found to seize exactly as often as with all runs.
    """
    ends = {
        made: [seen(k, made, samples) for k in range(made + 1)] for made in look_counts(samples)
    }
    for rate in (0.01, 0.03, 0.05, 0.06, 0.08, 0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 0.9):
        going, before, held, seizes = {0: 1.0}, 0, 0.0, 0.0
        for made, verdicts in ends.items():
            more = made - before
            came: dict[int, float] = {}
            for hits, chance in going.items():
                for k in range(more + 1):
                    own = chance * comb(more, k) * rate**k * (1.0 - rate) ** (more - k)
                    came[hits + k] = came.get(hits + k, 0.0) + own
            before, going = made, {}
            for hits, chance in came.items():
                verdict, certain = verdicts[hits]
                if made < samples and not certain:
                    going[hits] = chance
                    continue
                held += chance * (verdict.seized.low <= rate <= verdict.seized.high)
                seizes += chance * (verdict.result == "seizes")
        fixed = [
            (wilson(k, samples), comb(samples, k) * rate**k * (1.0 - rate) ** (samples - k))
            for k in range(samples + 1)
        ]
        alike = sum(chance for share, chance in fixed if share.low <= rate <= share.high)
        assert held >= min(alike, 0.95) - 1e-9
        assert seizes == pytest.approx(sum(c for share, c in fixed if share.low > 0.05))


@pytest.mark.parametrize("draws", [40, pytest.param(150, marks=pytest.mark.soak)])
def test_a_verdict_on_a_part_that_seizes_is_that_on_all_runs(draws: int) -> None:
    rng = np.random.default_rng(0)
    left = 0
    for _ in range(draws):
        chances = rng.dirichlet([1.0, 1.0, 1.0])
        own = rng.choice(["seized", "cleared", "hung_up"], size=36, p=chances).tolist()
        belt = rng.choice(["cleared", "slipping"], size=36, p=[0.8, 0.2]).tolist()
        whole = verdict_of(part_of(own, belt, 36, levels=3), "step")
        for made in look_counts(36):
            table = part_of(own[:made], belt[:made], 36, levels=3)
            verdict = verdict_of(table, "step")
            if made < 36 and verdict.result == "seizes" and is_certain(table, verdict):
                assert whole.result == "seizes"
                left += 1
                break
    assert left > draws / 3


@pytest.mark.parametrize(
    ("own", "belt", "certain"),
    [
        (["hung_up"] * 9, ["hung_up"] * 9, True),
        (["hung_up"] * 2 + ["cleared"] * 7, ["hung_up"] * 2 + ["cleared"] * 7, True),
        (["hung_up"] * 1 + ["cleared"] * 8, ["hung_up"] * 9, False),
        (["hung_up"] * 9, ["hung_up"] * 1 + ["cleared"] * 8, False),
        (["hung_up"] * 8 + ["seized"], ["hung_up"] * 8 + ["cleared"], False),
    ],
)
def test_the_belt_fails_for_certain_once_neither_can_reach_95_percent(
    own: list[str], belt: list[str], certain: bool
) -> None:
    """Two failures among 36 samples are too many; and none may have seized instead of the belt."""
    table = part_of(own, belt, 36)
    verdict = verdict_of(table, "step")
    assert verdict.result == "belt fails, too"
    assert is_certain(table, verdict) is certain


def test_fewer_runs_than_a_quarter_of_the_samples_are_not_enough() -> None:
    table = part_of(["hung_up"] * 9, ["hung_up"] * 9, 80)
    verdict = verdict_of(table, "step")
    assert verdict.result == "belt fails, too"
    assert not is_certain(table, verdict)


def test_an_obstacle_without_seizures_is_never_left_early() -> None:
    for made in look_counts(36):
        verdict, certain = seen(0, made, 36)
        assert not certain
    assert verdict.result == "does not seize"
