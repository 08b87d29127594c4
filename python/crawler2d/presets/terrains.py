"""Functions that make terrains: the short way to define the ground of a scenario."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

from crawler2d.common.arrays import real_number
from crawler2d.common.keywords import limits_hint, refuse_unknown
from crawler2d.errors import ScenarioError
from crawler2d.parameters.fields import field_hints
from crawler2d.parameters.terrain import (
    Barrier,
    DiagonalBarrier,
    Flat,
    Gap,
    HalfRound,
    Lanes,
    Points,
    Ramp,
    RandomStepfield,
    Ridge,
    Stairs,
    Step,
)
from crawler2d.presets.surveys import read_survey, simplified

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import ArrayLike

__all__ = [
    "barrier",
    "diagonal_barrier",
    "flat",
    "from_csv",
    "from_points",
    "gap",
    "half_round",
    "knife_edge",
    "lanes",
    "ramp",
    "random_stepfield",
    "ridge",
    "stairs",
    "step",
    "stepfield_with_barrier",
]


def __dir__() -> list[str]:
    """List what is public, for completion."""
    return sorted(__all__)


flat = Flat
step = Step
ramp = Ramp
barrier = Barrier
ridge = Ridge
gap = Gap
stairs = Stairs
half_round = HalfRound
lanes = Lanes
diagonal_barrier = DiagonalBarrier
random_stepfield = RandomStepfield


if not TYPE_CHECKING:  # mypy would accept any name

    def __getattr__(name: str) -> object:
        """Raise an AttributeError that explains limits of the side view."""
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}{limits_hint(name)}")


def knife_edge(height: float, *, thickness: float = 0.01, **fields: float) -> Barrier:
    """Make a barrier thin enough to fit between wheels.

    Parameters
    ----------
    height : float
        [m] Height, above 0.
    thickness : float
        [m] Thickness along x.
    **fields : float
        Further fields of `Barrier`, such as `edge_radius` [m] and `friction` [-].

    Returns
    -------
    Barrier
        The terrain.

    Examples
    --------
    >>> knife_edge(0.05).thickness
    0.01
    """
    return Barrier(height, thickness, **fields)


def stepfield_with_barrier(
    seed: int = 0,
    *,
    height: float | None = None,
    thickness: float = 0.1,
    yaw: float = 0.0,
    **fields: Any,
) -> RandomStepfield:
    """Make a random step field with a barrier across its middle.

    Parameters
    ----------
    seed : int
        Seed of the heights of the posts.
    height : float, optional
        [m] Height of the barrier. None takes one and a half times the largest possible height of a
        post, 0.15 m in the default field.
    thickness : float
        [m] Thickness of the barrier.
    yaw : float
        [rad] Yaw of the barrier, as for `DiagonalBarrier`.
    **fields
        Further fields of `RandomStepfield`.

    Returns
    -------
    RandomStepfield
        The terrain.

    Raises
    ------
    ScenarioError
        If the default height depends on fields that are not numbers.

    Notes
    -----
    "Gear Wheels based Simulation of Crawlers for Mobile Robot Servosila Engineer" drives over such
    fields (Table 2) without giving their dimensions. Its Figures 18 and 19 have barriers of 0.10
    and 0.20 m; 0.15 m is the mean, and the highest obstacle of its line of wheels (Table 3). The
    thickness, that of a post, is an estimate.

    Examples
    --------
    >>> stepfield_with_barrier(7, yaw=0.5).barrier_height
    0.15
    """
    field = RandomStepfield(seed, barrier_thickness=thickness, barrier_yaw=yaw, **fields)
    if height is None:
        rise = real_number(field.rise, "terrain.rise")
        highest = rise * real_number(field.levels, "terrain.levels")
        height = round(1.5 * highest, 9)  # to the nanometre, so that 0.15 stays 0.15
    return replace(field, barrier_height=height)


def from_points(points: ArrayLike, *, goal: float, **fields: Any) -> Points:
    """Make a terrain from any polyline.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        [m] Points (x, y) from left to right or from right to left; copied.
    goal : float
        [m] The x that the whole robot must pass.
    **fields
        Further fields of `Points`, such as `edge_radius` [m], `friction` and `segment_friction`
        [-].

    Returns
    -------
    Points
        The terrain.

    Raises
    ------
    ScenarioError
        If `points` is not an array of real numbers of that shape.

    Examples
    --------
    >>> from_points([[-2, 0], [0, 0], [0, 0.05], [3, 0.05]], goal=0.0).points[2]
    (0.0, 0.05)
    """
    return Points(cast("Any", points), goal=goal, **fields)


def from_csv(
    path: str | PathLike[str],
    *,
    goal: float,
    origin: float = 0.0,
    simplify: float | None = None,
    **fields: float,
) -> Points:
    r"""Make a terrain from a surveyed profile.

    Parameters
    ----------
    path : str or path-like
        A text file with a point on each line: x and y [m] in order, from left to right or from
        right to left, as for `from_points`. Separators are commas, semicolons, tabs or spaces; the
        decimal separator is a point. The first line may name the columns, but no units other than
        m; empty lines and comments after "#" are skipped.
    goal : float
        [m] The x that the whole robot must pass.
    origin : float
        [m] The x of the file that becomes x = 0. The robot starts to the left of the first edge at
        or beyond it; the file must have ground there.
    simplify : float, optional
        [m] Drop points within this distance of the line through the others (Douglas and Peucker).
        Remaining points do not move, so remaining edges are where they were surveyed; but lower
        edges vanish, a row of points round an edge becomes one or a few corners, and faces turn by
        up to this distance over their length. Round edges with `edge_radius`. Ground in a track
        counts from `criteria.intrusion_depth` on, 0.5 mm: if runs seize, use a fraction of that and
        compare. None keeps every point.
    **fields : float
        Further fields of `Points`, such as `edge_radius` [m] and `friction` [-].

    Returns
    -------
    Points
        The terrain.

    Raises
    ------
    ScenarioError
        If a line is not two finite numbers, x goes back, the file has fewer than two points or is
        not UTF-8 text; the message has path, line and value. If `origin` is not a number, or
        `simplify` not a number >= 0.
    ArgumentError
        If a keyword is neither an argument nor a field of `Points`.
    OSError
        If the file cannot be read.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> path = pathlib.Path(tempfile.mkdtemp(), "kerb.csv")
    >>> _ = path.write_text("x;y\n10;0\n11;0.001\n12;0\n12;0.08\n15;0.08\n")
    >>> from_csv(path, goal=0.0, origin=12.0, simplify=0.002).points
    ((-2.0, 0.0), (0.0, 0.0), (0.0, 0.08), (3.0, 0.08))
    """
    of_points = [name for name in field_hints(Points) if name != "points"]
    refuse_unknown("from_csv", fields, ["origin", "simplify", *of_points])
    points = read_survey(path)
    if simplify is not None:
        tolerance = real_number(simplify, "simplify")
        if not tolerance >= 0.0:
            raise ScenarioError("simplify", tolerance, "must be >= 0 m")
        points = simplified(points, tolerance)
    return from_points(points - (real_number(origin, "origin"), 0.0), goal=goal, **fields)
