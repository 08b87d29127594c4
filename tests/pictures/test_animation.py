"""Films of runs: number of frames, duration, and content of the last frame."""

import shutil
import struct
import sys
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from matplotlib import pyplot as plt
from PIL import Image

import crawler2d as c2d
from crawler2d.pictures import animation as filming
from crawler2d.pictures.animation import Film
from crawler2d.pictures.scenes import scene_of
from tests.shared import ROBOT, refused

HOLD = 1500  # [ms]
WHEELS = ROBOT.with_track(c2d.LineOfWheels(4, wheel_radius=0.0608))
has_ffmpeg = shutil.which("ffmpeg") is not None or find_spec("imageio_ffmpeg") is not None


@pytest.fixture(scope="module")
def short() -> c2d.Run:
    return c2d.simulate(WHEELS, c2d.terrains.step(0.075), duration=0.22)


@pytest.fixture(scope="module")
def seized() -> c2d.Run:
    return c2d.simulate(WHEELS, c2d.terrains.step(0.1), duration=4.0)


class Made(NamedTuple):
    path: Path
    calls: list[tuple[int, int]]
    """Reports of its progress."""


@pytest.fixture(scope="module", params=["gif", *(["MP4"] if has_ffmpeg else [])])
def made(
    request: pytest.FixtureRequest, short: c2d.Run, tmp_path_factory: pytest.TempPathFactory
) -> Made:
    """A film of four frames, of an odd width, which the format of an MP4 does not hold."""
    path = tmp_path_factory.mktemp("made") / f"run.{request.param}"
    calls: list[tuple[int, int]] = []
    short.animate(path, fps=10.0, width=201, progress=lambda *each: calls.append(each))
    return Made(path, calls)


def film_of(
    run: c2d.Run, times: Any, *, pace: float = 1.0, follow: bool | None = None, width: int = 300
) -> Film:
    """A film of one run as `Run.animate` makes it."""
    return Film(
        [run],
        times,
        labels=[run.subject],
        pace=pace,
        follow=follow,
        side_by_side=False,
        width=width,
    )


def frames_of(path: Path) -> list[tuple[int, Any]]:
    """[ms] Durations of the frames of a GIF, and their pixels."""
    found = []
    with Image.open(path) as image:
        for number in range(getattr(image, "n_frames", 1)):
            image.seek(number)
            found.append((int(image.info["duration"]), np.asarray(image.convert("RGB"))))
    return found


@pytest.mark.parametrize(
    ("fps", "speed", "count"),
    [
        pytest.param(25.0, 1.0, 7, marks=pytest.mark.soak),
        pytest.param(50.0, 1.0, 12, marks=pytest.mark.soak),
        pytest.param(10.0, 0.5, 6, marks=pytest.mark.soak),
        (20.0, 2.0, 4),
    ],
)
def test_a_gif_takes_as_long_as_the_run(
    short: c2d.Run, tmp_path: Path, fps: float, speed: float, count: int
) -> None:
    path = short.animate(tmp_path / "run.gif", fps=fps, speed=speed, width=300)
    assert path == tmp_path / "run.gif"
    frames = frames_of(path)
    assert len(frames) == count
    # The last frame is shown for the time of a frame, too, and then held.
    time = sum(duration for duration, _ in frames) - HOLD
    assert time == pytest.approx(1e3 * count / fps, abs=5.0)
    assert frames[0][1].shape[1] == 300
    assert [file.name for file in tmp_path.iterdir()] == ["run.gif"]


def test_the_robot_moves_in_a_gif_and_white_stays_white(seized: c2d.Run, tmp_path: Path) -> None:
    frames = frames_of(seized.animate(tmp_path / "run.gif", fps=1.0, width=300))
    assert len(frames) == 5
    for (_, one), (_, other) in pairwise(frames[:3]):
        assert np.count_nonzero((one != other).any(axis=2)) > 100
    assert all((pixels[0, 0] == 255).all() for _, pixels in frames)


def test_ten_seconds_of_a_gif_are_at_most_a_few_megabytes(tmp_path: Path) -> None:
    """The worst second: the largest number of gears turn close to the viewer."""
    track = c2d.CircumferentialWheels(24, wheel=c2d.GearWheel(grouser_count=8))
    run = c2d.simulate(ROBOT.with_track(track), c2d.terrains.flat(length=9.0), duration=1.0)
    path = run.animate(tmp_path / "run.gif", follow=True)
    assert path.stat().st_size < 500_000


def test_a_frame_shows_the_robot_between_two_samples(seized: c2d.Run) -> None:
    times = np.array([0.0, 1.2345, 2.0, float(seized.time[-1])])
    scene = scene_of(seized, times)
    assert scene.poses[0] == pytest.approx(seized.poses[0])
    assert scene.poses[-1] == pytest.approx(seized.poses[-1])
    after = int(np.searchsorted(seized.time, times[1]))
    share = (times[1] - seized.time[after - 1]) / (seized.time[after] - seized.time[after - 1])
    between = (1.0 - share) * seized.poses[after - 1] + share * seized.poses[after]
    # On its way from one sample to the next the robot turns by some thousandths of a radian.
    assert scene.poses[1] == pytest.approx(between, abs=1e-5)


def test_a_film_ends_with_the_outcome_and_begins_without(seized: c2d.Run) -> None:
    times = np.array([0.0, 1.0, float(seized.time[-1])])
    film = film_of(seized, times, pace=2.0)
    (ax,) = film.figure.axes
    told = []
    for number in range(3):
        film.show(number)
        film.figure.draw_without_rendering()
        told.append(ax.get_title(loc="left"))
    assert told == [
        "engineer, line, step: 0.00 s (2 x real time)",
        "engineer, line, step: 1.00 s (2 x real time)",
        seized.title,
    ]
    shown = [collection for collection in ax.collections if "force" in str(collection.get_label())]
    assert len(shown) == 1


def test_a_film_draws_each_body_once_and_moves_it(seized: c2d.Run) -> None:
    times = np.linspace(0.0, float(seized.time[-1]), 5)
    film = film_of(seized, times)
    (ax,) = film.figure.axes
    count = len(ax.get_lines())
    scene = scene_of(seized, times)
    for number in range(5):
        film.show(number)
        drawn = [np.array(line.get_xydata()) for line in ax.get_lines()]
        assert len(drawn) == count
        for body in scene.seen:
            outline = scene.outline(body, number)
            assert any(np.array_equal(outline, line) for line in drawn)


def test_the_view_follows_a_robot_that_goes_far() -> None:
    far = c2d.simulate(ROBOT, c2d.terrains.flat(length=9.0), duration=10.0)
    near = c2d.simulate(ROBOT, c2d.terrains.flat(), duration=1.0)
    for run, follow, moves in [(far, None, True), (near, None, False), (far, False, False)]:
        times = np.linspace(0.0, float(run.time[-1]), 7)
        film = film_of(run, times, follow=follow)
        (ax,) = film.figure.axes
        views = []
        scene = scene_of(run, times)
        for number in range(7):
            film.show(number)
            (left, right), x = ax.get_xlim(), scene.outline(0, number)[:, 0]
            assert left < x.min() < x.max() < right
            views.append((left, right))
        assert (len(set(views)) > 1) == moves
        assert np.ptp(np.diff(views)) < 1e-9  # the scale stays


@pytest.mark.skipif(not has_ffmpeg, reason="no ffmpeg")
@pytest.mark.parametrize("made", ["MP4"], indirect=True)
def test_an_mp4_has_every_frame(made: Made) -> None:
    data = made.path.read_bytes()
    assert data[4:8] == b"ftyp"
    # The header of the movie has time scale and duration.
    scale, duration = struct.unpack(">II", data[data.index(b"mvhd") + 16 :][:8])
    assert duration / scale == pytest.approx(4 / 10.0 + 1e-3 * HOLD, abs=0.05)
    assert [file.name for file in made.path.parent.iterdir()] == ["run.MP4"]


def test_a_run_of_one_sample_is_a_film_of_one_frame(tmp_path: Path) -> None:
    run = c2d.simulate(ROBOT, c2d.terrains.flat(), duration=0.0, gravity=0.0)
    ((duration, _),) = frames_of(run.animate(str(tmp_path / "run.gif"), width=300))
    assert duration == 40 + HOLD


@pytest.mark.parametrize("name", ["run.avi", "run", ".gif", "run.gif.txt"])
def test_another_suffix_is_refused(short: c2d.Run, tmp_path: Path, name: str) -> None:
    error = refused(lambda: short.animate(tmp_path / name))
    assert (error.path, error.rule) == ("path", "must end in .gif or .mp4")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "field",
    [
        {"fps": 0.5},
        {"fps": 51},
        {"fps": float("nan")},
        {"fps": "25"},
        {"speed": 0.0},
        {"speed": -1.0},
        {"speed": 4e-4},
        {"width": 100},
        {"follow": "no"},
    ],
)
def test_a_value_out_of_range_is_refused(
    short: c2d.Run, tmp_path: Path, field: dict[str, Any]
) -> None:
    error = refused(lambda: short.animate(tmp_path / "run.gif", **field))
    assert error.path == next(iter(field))
    assert list(tmp_path.iterdir()) == []


def test_a_film_of_more_than_ten_thousand_frames_is_refused(short: c2d.Run, tmp_path: Path) -> None:
    error = refused(lambda: short.animate(tmp_path / "run.gif", fps=50, speed=1e-3))
    assert (error.path, error.value) == ("speed", 1e-3)
    assert error.rule.startswith("must give at most 10000 frames")
    assert list(tmp_path.iterdir()) == []


def test_a_film_that_fails_leaves_the_old_one_and_nothing_else(
    short: c2d.Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    old = tmp_path / "run.gif"
    old.write_bytes(b"old")

    def fail(self: Film, number: int) -> None:  # noqa: ARG001
        if number == 3:
            raise KeyboardInterrupt

    monkeypatch.setattr(Film, "show", fail)
    for path in (old, *([tmp_path / "run.mp4"] if has_ffmpeg else [])):
        with pytest.raises(KeyboardInterrupt):
            short.animate(path, width=300)
    assert old.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [old]
    with pytest.raises(OSError, match="nowhere"):
        short.animate(tmp_path / "nowhere" / "run.gif")


@pytest.mark.skipif(sys.platform == "win32", reason="links take a privilege")
def test_a_film_goes_where_a_link_leads(short: c2d.Run, tmp_path: Path) -> None:
    link = tmp_path / "run.gif"
    link.symlink_to("a film")  # whose name does not say which format it has
    assert short.animate(link, fps=4.0, width=300) == link
    assert sorted(tmp_path.iterdir()) == [tmp_path / "a film", link]
    assert link.is_symlink()
    assert len(frames_of(tmp_path / "a film")) == 2


def test_a_folder_in_place_of_the_file_is_an_error_before_anything_is_drawn(
    short: c2d.Run, tmp_path: Path
) -> None:
    folder = tmp_path / "run.gif"
    folder.mkdir()
    drawn: list[tuple[int, int]] = []
    with pytest.raises(IsADirectoryError, match=r"run\.gif"):
        short.animate(folder, progress=lambda *each: drawn.append(each))
    assert drawn == []
    assert list(tmp_path.iterdir()) == [folder]


def test_the_comment_of_a_film_says_what_made_it(short: c2d.Run, made: Made) -> None:
    text = f"crawler2d {c2d.__version__}, scenario {short.scenario.identity}"
    assert short.provenance == text
    if made.path.suffix == ".gif":
        with Image.open(made.path) as image:
            assert image.info["comment"].decode() == text
    else:
        assert text.encode() in made.path.read_bytes()


def test_the_provenance_of_a_branch_names_its_parent(short: c2d.Run) -> None:
    branch = short.branch(0.1, track=c2d.BeltTrack(), duration=0.1)
    own, parent = branch.scenario.identity, short.scenario.identity
    assert own != parent
    made = f"crawler2d {c2d.__version__}, scenario {own}, branched off scenario {parent} at 0.1 s"
    assert branch.provenance == made


def test_a_film_leaves_no_figure_open(short: c2d.Run, tmp_path: Path) -> None:
    short.animate(tmp_path / "run.gif", fps=2.0, width=300)
    assert plt.get_fignums() == []


def test_a_run_without_history_has_no_film(tmp_path: Path) -> None:
    run = c2d.simulate(ROBOT, c2d.terrains.flat(), duration=0.2, record="summary")
    with pytest.raises(AttributeError, match="no history"):
        run.animate(tmp_path / "run.gif")
    assert list(tmp_path.iterdir()) == []


def test_a_missing_package_names_its_extra(
    short: c2d.Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", "")
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(ImportError, match=r"pip install 'crawler2d\[animation\]'"):
        short.animate(tmp_path / "run.mp4")
    monkeypatch.setitem(sys.modules, "PIL.Image", None)
    with pytest.raises(ImportError, match=r"pip install 'crawler2d\[animation\]'"):
        short.animate(tmp_path / "run.gif")
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ImportError, match="matplotlib"):
        short.animate(tmp_path / "run.gif")
    assert list(tmp_path.iterdir()) == []


def test_the_palette_of_a_gif_keeps_the_commonest_colours() -> None:
    pixels = np.full((50, 50, 3), 255, np.uint8)
    pixels[:10] = (217, 210, 197)
    pixels[10, :5] = (252, 252, 252)  # as close to white as Pillow's own search can tell
    palette = filming.palette_of(Image, pixels).getpalette()
    assert palette[:6] == [255, 255, 255, 217, 210, 197]
    assert 252 not in palette


def test_a_film_counts_its_frames(made: Made) -> None:
    assert made.calls == [(done, 4) for done in range(5)]


def test_a_film_shows_its_progress_unless_it_is_switched_off(
    short: c2d.Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    short.animate(tmp_path / "run.gif", fps=4.0, width=200)
    assert capsys.readouterr().err.splitlines()[-1].startswith("2 of 2 frames")
    short.animate(tmp_path / "run.gif", fps=4.0, width=200, progress=False)
    assert capsys.readouterr().err == ""
