"""Films of several runs: common time and scale, a title for each, and no partial files."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import crawler2d as c2d
from crawler2d.pictures.animation import Film
from tests.shared import ROBOT, refused

STEP = c2d.terrains.step(0.075)
TRACKS: dict[str, Any] = {
    "belt": c2d.BeltTrack(),
    "wheels": c2d.LineOfWheels(4, wheel_radius=0.0608),
}


@pytest.fixture(scope="module")
def pair() -> list[c2d.Run]:
    """A belt that has cleared the step after 3 s, and wheels that take two seconds longer."""
    return [
        c2d.simulate(ROBOT.with_track(TRACKS["belt"]), STEP, duration=3.0),
        c2d.simulate(ROBOT.with_track(TRACKS["wheels"]), STEP, duration=5.0),
    ]


def film_of(runs: list[c2d.Run], times: Any, **options: Any) -> Film:
    chosen: dict[str, Any] = {"pace": 1.0, "follow": None, "side_by_side": False, "width": 300}
    return Film(runs, np.array(times), labels=list(TRACKS), **chosen | options)


def titles(film: Film) -> list[str]:
    return [ax.get_title(loc="left") for ax in film.figure.axes]


def test_each_picture_has_the_time_until_its_run_has_ended(pair: list[c2d.Run]) -> None:
    film = film_of(pair, [0.0, 2.0, 4.0, 5.0])
    told = []
    for number in range(4):
        film.show(number)
        told.append(titles(film))
    assert told == [
        ["belt: 0.00 s", "wheels: 0.00 s"],
        ["belt: 2.00 s", "wheels: 2.00 s"],
        [f"belt: {pair[0].ending}", "wheels: 4.00 s"],
        [f"belt: {pair[0].ending}", f"wheels: {pair[1].ending}"],
    ]


def outlines(film: Film) -> list[Any]:
    """[m] All lines of the first picture."""
    return [np.array(line.get_xydata()) for line in film.figure.axes[0].get_lines()]


def unchanged(runs: list[c2d.Run], times: list[float], still: int) -> list[bool]:
    """Whether each frame has the first picture of one of them."""
    film, drawn = film_of(runs, times), []
    for number in range(len(times)):
        film.show(number)
        drawn.append(outlines(film))
    return [all(map(np.array_equal, drawn[still], each)) for each in drawn]


def test_a_run_that_has_ended_stands_still(pair: list[c2d.Run]) -> None:
    assert unchanged(pair, [2.0, 3.0, 4.0, 5.0], 1) == [False, True, True, True]


def test_a_branch_stands_still_until_it_branches_off(pair: list[c2d.Run]) -> None:
    branch = pair[1].branch(2.0, track=c2d.BeltTrack(), duration=1.0)
    same = unchanged([branch, pair[1]], [0.0, 1.0, 2.0, 2.5], 0)
    assert same == [True, True, True, False]


@pytest.mark.parametrize(
    ("side_by_side", "follow"),
    [
        (False, False),
        (True, True),
        pytest.param(False, True, marks=pytest.mark.soak),
        pytest.param(True, False, marks=pytest.mark.soak),
    ],
)
def test_all_pictures_have_one_size_and_one_scale(
    pair: list[c2d.Run], side_by_side: bool, follow: bool
) -> None:
    film = film_of(pair, [0.0, 3.0, 5.0], side_by_side=side_by_side, follow=follow)
    for number in range(3):
        film.show(number)
        film.figure.canvas.draw()
        one, other = film.figure.axes
        assert one.bbox.size == pytest.approx(other.bbox.size)
        spans = [np.diff([ax.get_xlim(), ax.get_ylim()], axis=1) for ax in (one, other)]
        assert spans[0] == pytest.approx(spans[1])
        apart = abs(one.bbox.min - other.bbox.min) >= one.bbox.size
        assert apart.tolist() == [side_by_side, not side_by_side]
        whole = film.figure.bbox
        for ax in (one, other):
            box = ax.get_tightbbox()
            assert whole.xmin <= box.xmin < box.xmax <= whole.xmax
            assert whole.ymin <= box.ymin < box.ymax <= whole.ymax


def test_one_legend_explains_what_any_picture_shows(pair: list[c2d.Run]) -> None:
    film = film_of(pair, [0.0])
    legends = [ax.get_legend() for ax in film.figure.axes]
    assert legends[0] is None
    told = [text.get_text() for text in legends[1].get_texts()]
    assert len(told) == len(set(told))
    assert any(text.startswith("envelope") for text in told)
    assert sum(text.startswith("contact forces") for text in told) == 1


def test_the_longest_arrows_are_of_larger_forces_too(pair: list[c2d.Run]) -> None:
    film = film_of(pair, [0.0])
    texts = film.figure.axes[1].get_legend().get_texts()
    (told,) = (text.get_text() for text in texts if text.get_text().startswith("contact forces"))
    assert told.endswith(" N or more")
    forces = [
        np.hypot(run.contacts["normal_force"], run.contacts["friction_force"]) for run in pair
    ]
    assert max(map(np.max, forces)) > float(told.split()[-4])


def test_arrows_of_robots_of_any_size_are_to_one_scale() -> None:
    small, large = (
        c2d.simulate(
            c2d.Robot.simple(mass, axle_distance=length, radius=0.1 * length),
            c2d.terrains.flat(),
            duration=1.0,
        )
        for mass, length in ((20.0, 0.4), (40.0, 0.8))
    )
    film = Film(
        [small, large],
        np.array([1.0]),
        labels=["small", "large"],
        pace=1.0,
        follow=None,
        side_by_side=False,
        width=300,
    )
    film.show(0)
    scales = []
    for run, ax in zip((small, large), film.figure.axes, strict=True):
        (arrows,) = [each for each in ax.collections if hasattr(each, "U")]
        last = run.contacts["time"] == run.time[-1]
        force = np.hypot(run.contacts["normal_force"], run.contacts["friction_force"])[last]
        scales.append(np.hypot(arrows.U, arrows.V).max() / force.max())
    assert scales[0] == pytest.approx(scales[1])


@pytest.mark.parametrize("side_by_side", [False, True])
def test_a_film_of_two_has_as_many_frames_as_the_longer_run(
    pair: list[c2d.Run], tmp_path: Path, side_by_side: bool
) -> None:
    calls: list[tuple[int, int]] = []
    path = c2d.animate(
        pair,
        tmp_path / "pair.gif",
        fps=1.0,
        width=300,
        side_by_side=side_by_side,
        progress=lambda *each: calls.append(each),
    )
    assert calls == [(done, 6) for done in range(7)]
    with Image.open(path) as image:
        assert image.size[0] == (600 if side_by_side else 300)
        assert image.info["comment"].decode() == "; ".join(run.provenance for run in pair)
        assert getattr(image, "n_frames", 1) > 3  # equal ones are merged
    assert list(tmp_path.iterdir()) == [path]


def test_without_labels_pictures_are_called_by_their_tracks(
    pair: list[c2d.Run], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[Film] = []
    build = Film.__init__

    def keep(self: Film, *args: Any, **options: Any) -> None:
        build(self, *args, **options)
        made.append(self)

    monkeypatch.setattr(Film, "__init__", keep)
    c2d.animate(pair, tmp_path / "pair.gif", fps=1.0, width=200, progress=False)
    assert titles(made[0]) == [
        f"smooth belt: {pair[0].ending}",
        f"4 round wheels in a line: {pair[1].ending}",
    ]


@pytest.mark.parametrize(
    ("make", "path"),
    [
        (lambda _pair: {"runs": []}, "runs"),
        (lambda pair: {"runs": pair[0]}, "runs"),
        (lambda pair: {"runs": pair * 7}, "runs"),
        (lambda pair: {"runs": [pair[0], pair[1].scenario]}, "runs[1]"),
        (lambda pair: {"runs": pair, "labels": ["one"]}, "labels"),
        (lambda pair: {"runs": pair, "labels": "ab"}, "labels"),
        (lambda pair: {"runs": pair, "labels": ["one", 2]}, "labels"),
        (lambda pair: {"runs": pair, "side_by_side": 1}, "side_by_side"),
        (lambda pair: {"runs": pair, "follow": "no"}, "follow"),
        (lambda pair: {"runs": pair, "progress": "yes"}, "progress"),
        (lambda pair: {"runs": pair, "path": "pair.avi"}, "path"),
        (lambda pair: {"runs": pair, "speed": 0.0}, "speed"),
    ],
)
def test_an_impossible_film_is_refused_and_leaves_no_file(
    pair: list[c2d.Run], tmp_path: Path, make: Any, path: str
) -> None:
    chosen = make(pair)
    file = tmp_path / chosen.pop("path", "pair.gif")
    assert refused(lambda: c2d.animate(path=file, **chosen)).path == path
    assert list(tmp_path.iterdir()) == []


def test_a_run_without_history_makes_no_film(pair: list[c2d.Run], tmp_path: Path) -> None:
    summary = c2d.simulate(ROBOT, STEP, duration=0.2, record="summary")
    with pytest.raises(AttributeError, match="no history"):
        c2d.animate([pair[0], summary], tmp_path / "pair.gif")
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_not_there_is_an_error_before_anything_is_drawn(
    pair: list[c2d.Run], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: Any, **__: Any) -> None:
        raise AssertionError("drawn")

    monkeypatch.setattr(Film, "__init__", fail)
    with pytest.raises(FileNotFoundError, match="nowhere"):
        c2d.animate(pair, tmp_path / "nowhere" / "pair.gif")
