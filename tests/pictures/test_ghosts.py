"""Final poses of trials in plots and on pages."""

import json
import re

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.pictures.scenes import ghost_lines, ghosts, scene_of
from tests.shared import ROBOT, with_flippers

WHEELS = c2d.LineOfWheels(4)
RUNS = {
    "wheels": c2d.Scenario(ROBOT.with_track(WHEELS), c2d.terrains.step(0.10), duration=8.0),
    "flippers": c2d.Scenario(
        with_flippers(WHEELS), c2d.terrains.step(0.3, friction=0.4), duration=8.0
    ),
    "rear flippers": c2d.Scenario(
        c2d.robots.absolem(track=c2d.LineOfWheels(3)),
        c2d.terrains.step(0.5, friction=0.4),
        duration=8.0,
    ),
    # Coarse, with few shoes: its end does not matter here.
    "chain": c2d.Scenario(
        ROBOT.with_track(c2d.SegmentalTrack(shoe_count=22)),
        c2d.terrains.step(0.3, friction=0.4),
        start=c2d.Start(approach=0.05),
        solver=c2d.Solver(accuracy=1e-4),
        duration=2.0,
    ),
}


@pytest.fixture(scope="module", params=RUNS)
def run(request: pytest.FixtureRequest) -> c2d.Run:
    return c2d.simulate(RUNS[request.param], trials="all")


def test_a_ghost_stands_where_the_run_of_its_trial_ends(run: c2d.Run) -> None:
    shown = ghosts(run)
    trials = [trial for trial in run.trials() if trial.name not in ("unchanged", "rebuilt")]
    assert len(shown) == len(trials) >= 3
    # A chain takes half a second to its end, and its trials end like those of others: two.
    every = len(shown) // 2 if run.scenario == RUNS["chain"] else 1
    for ghost, trial in list(zip(shown, trials, strict=True))[::every]:
        ends = [carrier.poses[-1] for carrier in scene_of(trial.run).carriers]
        assert ghost.frames == pytest.approx(np.array(ends), abs=1e-9), trial.name
        assert ghost.result.startswith(f"{ghost.change}: ")
        assert ghost.freed == trial.freed


def test_the_lines_of_a_ghost_are_the_bodies_of_the_robot_moved_as_a_whole(run: c2d.Run) -> None:
    scene = scene_of(run)
    for ghost in ghosts(run):
        lines = list(ghost_lines(scene, ghost))
        points = np.vstack(lines)
        reach = max(np.hypot(*carrier.envelope.T).max() for carrier in scene.carriers)
        away = [np.hypot(*(points - frame[:2]).T) for frame in ghost.frames]
        assert np.min(away, axis=0).max() < reach + 0.1
        assert all(np.array_equal(line[0], line[-1]) for line in lines)


def test_a_plot_shows_the_ends_of_the_trials_that_freed_the_robot(run: c2d.Run) -> None:
    ends = [ghost for ghost in ghosts(run) if not ghost.from_the_start]
    freed = [ghost.change for ghost in ends if ghost.freed]
    legend = run.plot().get_legend()
    assert legend is not None
    labels = [text.get_text() for text in legend.get_texts()]
    found = [label for label in labels if label.startswith("end of the trial: ")]
    assert found == [f"end of the trial: {change}" for change in freed]
    bare = run.plot(trials=False).get_legend()
    assert bare is not None
    assert not any("trial" in text.get_text() for text in bare.get_texts())
    # Before its end there is nothing for comparison.
    early = run.plot(time=1.0).get_legend()
    assert early is not None
    assert not any("trial" in text.get_text() for text in early.get_texts())


def test_a_page_lists_every_trial_with_its_ghost(run: c2d.Run) -> None:
    page = run.to_html()
    shown = ghosts(run)
    buttons = re.findall(r'data-trial="(\d+)"[^>]*>([^<]*)</button>', page)
    assert buttons == [(str(n), ghost.result) for n, ghost in enumerate(shown)]
    text = re.search(r'id="recording">(.*?)</script>', page, re.DOTALL)
    assert text is not None
    data = json.loads(text[1])["ghosts"]
    assert [each["belt"] for each in data] == [ghost.is_belt for ghost in shown]
    for each, ghost in zip(data, shown, strict=True):
        assert np.array(each["frames"]) == pytest.approx(ghost.frames, abs=1e-5)


def test_the_words_of_a_page_have_their_meanings() -> None:
    run = c2d.simulate(RUNS["wheels"], trials=None)
    page = run.to_html()
    assert f'title="{c2d.Outcome.SEIZED.meaning}"' in page
    assert run.mechanism is not None
    assert f"how the ground inside is held: {run.mechanism.meaning}" in page
    cleared = c2d.simulate(ROBOT, c2d.terrains.step(0.05)).to_html()
    assert "data-trial" not in cleared.split('id="recording"')[0]
