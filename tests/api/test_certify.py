"""Certificates, and an independent check, point by point, of the reasons that exclude cells."""

import dataclasses
import json
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import crawler2d as c2d
from crawler2d.studies import certify
from crawler2d.studies.certificates import Certificate

ROBOT = dataclasses.replace(c2d.robots.engineer(flippers=None), belly=None)
BASE = c2d.Scenario(ROBOT.with_track(c2d.LineOfWheels(7)), c2d.terrains.step(0.1))
OVER = {"terrain.height": (0.02, 0.04), "terrain.friction": (0.6, 1.0)}
PART = {"terrain.height": (0.05, 0.12), "terrain.friction": (0.4, 1.2)}


@pytest.fixture(scope="module")
def whole() -> Certificate:
    return certify(BASE, OVER, keep_cells=True)


@pytest.fixture(scope="module")
def part() -> Certificate:
    return certify(BASE, PART, smallest=0.25)


def test_low_steps_are_certified_for_seven_wheels(whole: Certificate) -> None:
    assert whole.holds
    assert whole.share("certified") == pytest.approx(1.0)
    assert str(whole).startswith("certified: no equilibrium with running drives and more than 1 mm")
    assert "terrain.height from 0.02 to 0.04 and terrain.friction from 0.6 to 1;" in str(whole)
    assert "rocking without rest is not excluded" in str(whole)


def test_where_it_can_jam_an_example_jam_is_named(part: Certificate) -> None:
    assert not part.holds
    assert "% where it can jam, as at terrain.height = " in str(part)
    height, friction, x, y, angle = part.witness[part.status == "jams"][0]
    found = c2d.jams(BASE.robot, c2d.terrains.step(height), friction=friction)
    poses = [(*jam.position, jam.chassis_angle) for jam in found]
    assert np.abs(np.array(poses) - (x, y, angle)).max(axis=1).min() < 1e-6


def test_shares_add_up_and_figures_show_them(part: Certificate) -> None:
    statuses = ("certified", "as a belt", "jams", "undecided")
    assert sum(map(part.share, statuses)) == pytest.approx(1.0)
    axes = part.plot()
    assert len(axes.patches) == len(part.status)
    along = certify(BASE, {"terrain.height": (0.02, 0.04)}, smallest=0.5)
    assert along.plot().get_xlabel() == "height [m]"
    with pytest.raises(
        c2d.ScenarioError, match=r"status must be one of certified, jams, as a belt"
    ):
        part.share("proven")


@pytest.mark.parametrize(
    ("edge", "certified", "jams"),
    [
        (0.999, "more than 99 % certified", "less than 1 % where it can jam"),
        (0.75, "75 % certified", "25 % where it can jam"),
        (0.001, "less than 1 % certified", "more than 99 % where it can jam"),
    ],
)
def test_an_incomplete_share_is_not_rounded_to_100_percent(
    edge: float, certified: str, jams: str
) -> None:
    found = Certificate(
        fields=("terrain.friction",),
        ranges=np.array([[0.0, 1.0]]),
        depth=1e-3,
        low=np.array([[0.0], [edge]]),
        high=np.array([[edge], [1.0]]),
        status=np.array(["certified", "jams"]),
        witness=np.array([[np.nan] * 4, [0.9995, 0.0, 0.0, 0.0]]),
        count=np.array([1, 0]),
        cells=None,
    )
    assert f": {certified}: no equilibrium" in str(found)
    assert f"; {jams}, as at terrain.friction = 0.9995" in str(found)
    alone = dataclasses.replace(found, status=np.array(["jams", "jams"]))
    assert "0 % certified: no equilibrium" in str(alone)
    assert "; 100 % where it can jam" in str(alone)


def test_regions_of_three_fields_have_no_figure() -> None:
    low_and_high = {
        "terrain.height": 0.05,
        "terrain.friction": 0.5,
        "robot.center_of_mass[1]": 0.02,
    }
    over = {field: (low, 1.001 * low) for field, low in low_and_high.items()}
    with pytest.raises(c2d.ScenarioError, match="plot must vary one field or two"):
        certify(BASE, over, most_cells=10).plot()


def test_where_nothing_is_certified_there_are_no_cells() -> None:
    found = certify(BASE, OVER, most_cells=1, smallest=1.0, keep_cells=True)
    assert found.share("undecided") == 1.0
    assert found.cells is not None
    shapes = {name: column.shape for name, column in found.cells.items()}
    ends = (0, 3 + len(OVER))
    assert shapes == {"low": ends, "high": ends, "exclusion": (0,), "motion": (0, 3)}


@pytest.mark.parametrize(
    ("over", "options", "message"),
    [
        ({}, {}, r"over must be a mapping of 1 to 4 fields"),
        ({"terrain.height": (0.1, 0.1)}, {}, r"over\['terrain.height'\] must be two numbers"),
        ({"terrain.height": 0.1}, {}, r"over\['terrain.height'\] must be two numbers"),
        ({"terrain.width": (0.1, 0.2)}, {}, r"terrain.width must be a known field"),
        ({"robot.mass": (10.0, 20.0)}, {}, r"over must move the centre of mass"),
        ({"robot.outline.axle_distance": (0.3, 0.4)}, {}, r"over must move the centre of mass"),
        (OVER, {"depth": 0.0}, r"depth must be > 0 m"),
        (OVER, {"smallest": 0.0}, r"smallest must be >= 1/1024"),
        (OVER, {"most_cells": 0}, r"most_cells must be"),
        (OVER, {"keep_cells": "no"}, r"keep_cells must be True or False"),
    ],
)
def test_models_that_cannot_be_certified_are_refused(
    over: Any, options: dict[str, Any], message: str
) -> None:
    with pytest.raises(c2d.ScenarioError, match=message):
        certify(BASE, over, **options)


def test_a_belt_is_what_wheels_are_compared_with() -> None:
    base = BASE.replace({"robot": ROBOT.with_track(c2d.BeltTrack())})
    with pytest.raises(c2d.ScenarioError, match=r"robot.track must have wheels"):
        certify(base, OVER)


SAMPLES = 40


def test_the_reason_that_excludes_a_cell_holds_at_each_of_its_points(whole: Certificate) -> None:
    """Of 1,000 cells of all kinds, 40 poses, heights and frictions each."""
    assert whole.cells is not None
    random = np.random.default_rng(0)
    kinds = whole.cells["exclusion"]
    checked = dict.fromkeys(("apart", "overlap", "belt", "unbalanced", "tips"), 0)
    for i in random.permutation(len(kinds))[:1000]:
        kind = str(kinds[i])
        low, high = (whole.cells[end][i] for end in ("low", "high"))
        points = random.uniform(low, high, (SAMPLES, len(low)))
        view = View(points)
        if kind == "apart":
            # Each wheel is on one side of the surface everywhere.
            assert (np.sign(view.gaps) == np.sign(view.gaps[0])).all()
        elif kind == "overlap":
            assert (view.gaps < 0.0).any(axis=1).all()
        elif kind == "belt":
            assert (view.corner_depth < whole.depth)[view.is_free].all()
        elif kind == "unbalanced":
            checked[kind] += view.resisted(whole.cells["motion"][i], low, high)
            continue
        checked[kind] += 1
    assert checked["unbalanced"] > 300
    assert all(checked[kind] > 0 for kind in ("apart", "overlap", "belt", "tips")), checked


class View:
    """Robots at steps: x, y and angle, with height and friction of each robot's own step."""

    def __init__(self, points: NDArray[np.float64]) -> None:
        self.points = points
        wheels = BASE.robot.wheels()
        self.radius = wheels["radius"]
        self.place = np.stack([wheels["x"], wheels["y"]], axis=-1)
        self.gaps, _ = self._gaps(self.axles(points[:, None]), points[:, 3, None])
        self.is_free = (self.gaps >= 0.0).all(axis=1)

    def axles(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        x, y, angle = np.moveaxis(points[..., :3], -1, 0)
        cosine, sine = np.cos(angle), np.sin(angle)
        along, up = self.place.T
        return np.stack([x + cosine * along - sine * up, y + sine * along + cosine * up], axis=-1)

    def _gaps(
        self, axles: NDArray[np.float64], height: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Distances of wheels from a step at x = 0, negative inside, and directions."""
        x, y = axles[..., 0], axles[..., 1]
        onto = [
            np.stack([np.minimum(x, 0.0), np.zeros_like(x)], axis=-1),
            np.stack([np.zeros_like(x), np.clip(y, 0.0, height)], axis=-1),
            np.stack([np.maximum(x, 0.0), np.broadcast_to(height, x.shape)], axis=-1),
        ]
        away = axles - np.stack(onto)
        distances = np.linalg.norm(away, axis=-1)
        nearest = distances.argmin(axis=0)
        distance = np.take_along_axis(distances, nearest[None], axis=0)[0]
        is_inside = np.where(x < 0.0, y < 0.0, y < height)
        normal = np.take_along_axis(away, nearest[None, ..., None], axis=0)[0]
        normal /= np.where(distance > 0.0, distance, 1.0)[..., None]
        return np.where(is_inside, -distance, distance) - self.radius, normal

    @property
    def corner_depth(self) -> NDArray[np.float64]:
        """[m] Depth of the corner inside the belt round equal wheels in a row."""
        x, y, angle, height = self.points[:, :4].T
        along = -np.cos(angle) * x + np.sin(angle) * (height - y)
        up = np.sin(angle) * x + np.cos(angle) * (height - y)
        nearest = np.clip(along, self.place[:, 0].min(), self.place[:, 0].max())
        return np.asarray(self.radius[0] - np.hypot(along - nearest, up - self.place[0, 1]))

    def resisted(
        self, motion: NDArray[np.float64], low: NDArray[np.float64], high: NDArray[np.float64]
    ) -> int:
        """Set each wheel on the surface within the cell, and return whether its force has power."""
        vx, vy, rate = motion
        assert vy < 0.0  # the weight works
        # Each wheel has its own poses.
        touching = np.repeat(self.points[:, None], len(self.radius), axis=1)
        # Along the vertical, by Newton's steps.
        for _ in range(8):
            gaps, normals = self._gaps(self.axles(touching), touching[..., 3])
            touching[..., 1] -= gaps / np.where(
                np.abs(normals[..., 1]) > 0.2, normals[..., 1], np.inf
            )
        axles = self.axles(touching)
        gaps, normal = self._gaps(axles, touching[..., 3])
        is_there = (
            (np.abs(gaps) < 1e-9) & (touching[..., 1] > low[1]) & (touching[..., 1] < high[1])
        )
        along = np.stack([normal[..., 1], -normal[..., 0]], axis=-1)
        force = normal + touching[..., 4, None] * along
        arm = axles - self.radius[:, None] * normal - View.center(touching)
        velocity = np.stack([vx - rate * arm[..., 1], vy + rate * arm[..., 0]], axis=-1)
        power = (force * velocity).sum(axis=-1)
        assert (power[is_there] > 0.0).all()
        return int(is_there.any())

    @staticmethod
    def center(points: NDArray[np.float64]) -> NDArray[np.float64]:
        along, up = BASE.robot.center_of_mass
        x, y, angle = np.moveaxis(points[..., :3], -1, 0)
        cosine, sine = np.cos(angle), np.sin(angle)
        return np.stack([x + cosine * along - sine * up, y + sine * along + cosine * up], axis=-1)


def test_its_cells_are_plain_numbers(whole: Certificate) -> None:
    assert whole.cells is not None
    count = len(whole.cells["exclusion"])
    assert whole.count.sum() == count
    assert whole.cells["low"].shape == (count, 5)
    json.dumps({name: column[:3].tolist() for name, column in whole.cells.items()})


def test_more_cells_than_memory_holds_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CRAWLER2D_MEMORY", "1")
    with pytest.raises(c2d.LimitError, match=r"cells of a region \(most_cells\) needs about"):
        certify(BASE, OVER, most_cells=10_000_000)


def test_a_jam_at_an_end_of_a_range_is_found_from_either_side() -> None:
    wheels = (
        (-0.0734362765, -0.0264620700, 0.0384768006),
        (0.0890996027, -0.0257243830, 0.0447247213),
        (0.1662377896, -0.0061532912, 0.0458796288),
    )
    found = []
    for sign in (1, -1):
        placed = c2d.HybridWheels(tuple((sign * x, y, r) for x, y, r in wheels[::sign]))
        robot = dataclasses.replace(
            ROBOT.with_track(placed), center_of_mass=(sign * 0.0302745366, 0.0331594164)
        )
        barrier = c2d.terrains.barrier(0.06, thickness=0.0967634700, friction=0.8)
        base = c2d.Scenario(robot, barrier, drive=c2d.Drive(speed=0.3 * sign))
        over = {"terrain.height": (0.0518101879, 0.0718101879)}
        found.append(certify(base, over, smallest=0.125, most_cells=10_000))
    assert found[0].status.tolist() == found[1].status.tolist()
    assert "undecided" not in found[0].status
