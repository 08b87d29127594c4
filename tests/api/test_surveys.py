"""`terrains.from_csv`: surveyed profiles, read from a file and simplified."""

import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import crawler2d as c2d
from crawler2d.errors import ArgumentError
from crawler2d.presets.surveys import simplified
from tests.shared import ROBOT, refused

POINTS = ((-2.0, 0.0), (0.0, 0.0), (0.0, 0.05), (1.5, 0.0625), (3.0, 0.05))
ROWS = [f"{x!r} {y!r}" for x, y in POINTS]


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "survey.csv"


def read(file: Path, text: str) -> tuple[tuple[float, float], ...]:
    file.write_bytes(text.encode())
    return c2d.terrains.from_csv(file, goal=0.0).points


@pytest.mark.parametrize("separator", [",", ";", "\t", " ", ", ", " ; ", "   "])
@pytest.mark.parametrize("header", [None, "x{}y", "x [m]{}y [m]", "station{}height"])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
@pytest.mark.parametrize("mark", ["", "\ufeff"], ids=["", "byte order mark"])
def test_every_usual_file_format_gives_the_same_points(
    file: Path, separator: str, header: str | None, end: str, mark: str
) -> None:
    lines = [row.replace(" ", separator) for row in ROWS]
    if header is not None:
        lines.insert(0, header.format(separator))
    assert read(file, mark + end.join(lines) + end) == POINTS


def test_empty_lines_comments_and_a_missing_last_newline_do_not_matter(file: Path) -> None:
    text = "# a survey\n\n" + "\n\n".join(ROWS[:2]) + "\n# half\n" + "  # here\n".join(ROWS[2:])
    assert read(file, text) == POINTS


def test_every_bit_of_a_number_is_read(file: Path) -> None:
    points = [(0.1 * k, 1.0 / (3.0 + k)) for k in range(1000)]
    assert read(file, "\n".join(f"{x!r},{y!r}" for x, y in points)) == tuple(points)


def test_a_survey_from_right_to_left_is_the_same_ground(file: Path) -> None:
    points = read(file, "\n".join(reversed(ROWS)))
    there = c2d.terrains.from_points(points, goal=0.0)
    back = c2d.terrains.from_points(POINTS, goal=0.0)
    places = np.linspace(-2.0, 3.0, 101)
    assert points == POINTS[::-1]
    assert np.array_equal(there.height_at(places), back.height_at(places))


@pytest.mark.parametrize(
    ("text", "where", "value", "rule"),
    [
        ("0 0\n1 0\n0.5 0.2\n2 0\n", ", line 3,", "0.5", "must not go back from x = 1 m"),
        ("2 0\n0.5 0.2\n1 0\n0 0\n", ", line 3,", "1.0", "must not go back from x = 0.5 m"),
        ("x y\n\n0 0\n1 nan\n", ", line 4,", "nan", "must have finite numbers"),
        ("0 0\n1 -inf\n", ", line 2,", "-inf", "must have finite numbers"),
        ("0 0\n1 0.1m\n", ", line 2,", "0.1m", "must have finite numbers"),
        ("x y\nx y\n0 0\n1 0\n", ", line 2,", "x", "must have finite numbers"),
        ("0 0\n1,\n", ", line 2,", "", "must have finite numbers"),
        ("0\n1\n", ", line 1,", "0", "must have two numbers"),
        ("0 0 0\n1 0 0\n", ", line 1,", "0 0 0", "must have two numbers"),
        ("0,5;0,1\n1,5;0,1\n", ", line 1,", "0,5;0,1", "with decimal points"),
        ("", "", "0", "must have at least 2 lines with a point"),
        ("x [mm],y [mm]\n0,0\n1,0\n", ", line 1,", "x [mm],y [mm]", "must name x and then y, in m"),
        ("y;x\n0;0\n1;0\n", ", line 1,", "y;x", "must name x and then y, in metres"),
        ("x,y\n", "", "0", "must have at least 2 lines with a point"),
        ("x,y\n0,0\n", "", "1", "must have at least 2 lines with a point"),
    ],
)
def test_a_file_that_is_no_profile_is_refused_with_line_value_and_rule(
    file: Path, text: str, where: str, value: str, rule: str
) -> None:
    error = refused(lambda: read(file, text))
    assert error.path == f"{file}{where}"
    assert str(error.value) == value
    assert rule in error.rule
    assert str(error).startswith(f"{file}{where} must")
    assert re.search(rf", got {re.escape(value)}(:|$)", str(error))


def test_bytes_that_are_no_text_are_refused(file: Path) -> None:
    file.write_bytes("0,0\n1,1\n".encode("utf-16"))
    error = refused(lambda: c2d.terrains.from_csv(file, goal=0.0))
    assert (error.path, error.rule) == (str(file), "must be a text in UTF-8")


def test_a_missing_file_is_an_os_error(file: Path) -> None:
    with pytest.raises(FileNotFoundError):
        c2d.terrains.from_csv(file, goal=0.0)


def test_overhangs_are_refused_as_in_from_points(file: Path) -> None:
    overhang = [(-2, 0), (1, 0), (0.5, 0.2), (3, 0.2)]
    text = "\n".join(f"{x} {y}" for x, y in overhang)
    assert "overhangs" in refused(lambda: read(file, text)).rule
    ground = c2d.terrains.from_points(overhang, goal=1.0)
    assert "overhangs" in refused(lambda: c2d.Scenario(ROBOT, ground).validate()).rule


def test_a_survey_can_be_driven_on_from_an_origin_of_its_own(file: Path) -> None:
    file.write_text("\n".join(f"{x + 100.0} {y}" for x, y in POINTS))
    ground = c2d.terrains.from_csv(file, goal=0.0, origin=100.0, friction=0.8)
    assert (ground.points, ground.friction) == (POINTS, 0.8)
    same = c2d.terrains.from_points(POINTS, goal=0.0, friction=0.8)
    runs = [c2d.simulate(ROBOT, each, record="summary") for each in (ground, same)]
    assert runs[0].metrics == runs[1].metrics
    assert str(runs[0].outcome) == "cleared"


LINES = st.lists(
    st.tuples(st.sampled_from([0.0, 0.01, 0.1, 1.0]), st.floats(-0.5, 0.5)), min_size=2, max_size=60
)


@given(steps=LINES, tolerance=st.sampled_from([0.0, 1e-3, 0.02, 0.3]))
def test_removed_points_lie_within_the_distance_of_the_simplified_profile(
    steps: list[tuple[float, float]], tolerance: float
) -> None:
    x, y = np.array(steps).T
    points = np.column_stack([np.cumsum(x), y])
    kept = simplified(points, tolerance)
    assert {tuple(row) for row in kept} <= {tuple(row) for row in points}
    assert np.array_equal(kept[[0, -1]], points[[0, -1]])
    starts, along = kept[:-1], np.diff(kept, axis=0)
    for point in points:
        lengths = np.maximum((along**2).sum(axis=1), 1e-300)
        share = np.clip(((point - starts) * along).sum(axis=1) / lengths, 0.0, 1.0)
        feet = starts + share[:, None] * along
        assert np.hypot(*(point - feet).T).min() <= tolerance + 1e-9


def test_simplifying_keeps_edges_where_they_are_and_drops_lower_ones(file: Path) -> None:
    noise = np.random.default_rng(2).uniform(-1e-3, 1e-3, 2000)
    x = np.linspace(-3.0, 3.0, 2000)
    y = noise + np.where(x > 0.0, 0.08, 0.0)
    file.write_text("\n".join(f"{a!r},{b!r}" for a, b in zip(x.tolist(), y.tolist(), strict=True)))
    every = c2d.terrains.from_csv(file, goal=0.0)
    fewer = c2d.terrains.from_csv(file, goal=0.0, simplify=0.004)
    assert len(every.points) == 2000
    assert len(fewer.points) < 20
    assert set(fewer.points) <= set(every.points)
    foot, top = (max(a for a in x if a <= 0.0), min(a for a in x if a > 0.0))
    assert {foot, top} <= {a for a, _ in fewer.points}


@pytest.mark.parametrize("simplify", [-1e-3, float("nan"), "1 mm", True])
def test_an_invalid_distance_is_refused(file: Path, simplify: float) -> None:
    file.write_text("\n".join(ROWS))
    error = refused(lambda: c2d.terrains.from_csv(file, goal=0.0, simplify=simplify))
    assert error.path == "simplify"


def test_an_invalid_origin_is_refused(file: Path) -> None:
    file.write_text("\n".join(ROWS))
    assert refused(lambda: c2d.terrains.from_csv(file, goal=0.0, origin="0")).path == "origin"  # type: ignore[arg-type]


@pytest.mark.parametrize("keyword", ["simplfy", "orign", "edge_radus"])
def test_a_misspelt_keyword_is_answered_with_the_nearest(file: Path, keyword: str) -> None:
    file.write_text("\n".join(ROWS))
    meant = {"simplfy": "simplify", "orign": "origin", "edge_radus": "edge_radius"}[keyword]
    with pytest.raises(ArgumentError, match=rf"did you mean {meant}\?"):
        c2d.terrains.from_csv(file, goal=0.0, **{keyword: 0.1})
