"""Certificates: ranges of height, friction and centre of mass in which a robot cannot jam."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d import _core
from crawler2d.common.arrays import ByValue, read_bool, read_range, real_number, whole_number
from crawler2d.common.keywords import takes_keywords
from crawler2d.errors import ScenarioError
from crawler2d.parameters.fields import read_number_path
from crawler2d.parameters.scenario import Scenario, check_scenario
from crawler2d.pictures.certificates import plot_regions
from crawler2d.runs.jams import on_belt
from crawler2d.sweeps.axes import field_attributes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

__all__ = ["Certificate", "certify"]

_MOST_FIELDS = 4
"""Largest number of varying fields."""

_STATUSES = {-1: "jams", -2: "as a belt", -3: "undecided"}
"""Statuses of regions without a proof."""

_EXCLUSIONS = "apart", "overlap", "belt", "unbalanced", "tips"
"""Reasons why a cell has no jam, in the order of the core."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Certificate(ByValue):
    """Ranges of fields in which a robot cannot jam; ``str(certificate)`` summarises it.

    Attributes
    ----------
    fields : tuple of str
        Paths of the F varying fields.
    ranges : ndarray of float, shape (F, 2)
        Their smallest and largest values.
    depth : float
        [m] Only jams with at least this depth of ground inside the track are excluded.
    low, high : ndarray of float, shape (N, F)
        Bounds of the regions, which cover all values exactly once.
    status : ndarray of str, shape (N,)
        Result for each:

        - `certified`: it has no jam with ground that deep inside the track;
        - `as a belt`: it may have one, but a belt round the same wheels can jam at each of its
          values;
        - `jams`: at `witness` it has one on three contacts;
        - `undecided`: none of these was shown.
    witness : ndarray of float, shape (N, F + 3)
        Values of the fields, and x [m], y [m] and angle [rad] of the chassis in a jam; NaN without
        one.
    count : ndarray of int, shape (N,)
        Number of cells that certify a region, else 0.
    cells : dict of ndarray or None
        These M cells, in the order of the certified regions, if requested. `low` and `high`, shape
        (M, 3 + F): x [m], y [m] and angle [rad] of the chassis, and the fields. `exclusion`, shape
        (M,): `apart`, nothing can touch; `overlap`, a part overlaps the ground; `belt`, no ground
        is that deep inside the track; `unbalanced`, no forces carry the weight; `tips`, forces on
        one or two wheels carry it, but small deviations grow. `motion`, shape (M, 3): for
        `unbalanced`, a velocity of the centre of mass [m/s] and a rate of rotation [rad/s] at which
        the weight does work and no contact resists; NaN for others.
    """

    fields: tuple[str, ...]
    ranges: NDArray[np.float64]
    depth: float
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    status: NDArray[np.str_]
    witness: NDArray[np.float64]
    count: NDArray[np.int64]
    cells: dict[str, NDArray[Any]] | None

    @property
    def holds(self) -> bool:
        """Whether the robot can jam nowhere, or only where a belt can, too."""
        return bool(np.isin(self.status, ["certified", "as a belt"]).all())

    def share(self, status: str) -> float:
        """Return the fraction of all values that has a status.

        Raises
        ------
        ScenarioError
            If the status is unknown.
        """
        known = "certified", *_STATUSES.values()
        if status not in known:
            raise ScenarioError("status", status, f"must be one of {', '.join(known)}")
        sizes = ((self.high - self.low) / np.diff(self.ranges, axis=1).T).prod(axis=1)
        return float(sizes[self.status == status].sum())

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the regions over one or two fields; takes and returns one matplotlib Axes.

        Raises
        ------
        ScenarioError
            If more than two fields vary.
        """
        if len(self.fields) > 2:
            raise ScenarioError("plot", self.fields, "must vary one field or two")
        statuses = map(str, self.status)
        regions = list(zip(statuses, self.low, self.high, strict=True))
        ax = plot_regions(regions, self.ranges, list(map(_label, self.fields)), ax)
        inside = f"{1e3 * self.depth:g} mm of ground or more inside the track"
        text = f"where it can stand still with its drives running, with {inside}"
        ax.set_title(text, loc="left", fontsize="small", parse_math=False)
        return ax

    def __str__(self) -> str:
        """Describe what is certified, and what it means."""
        pairs = zip(self.fields, self.ranges, strict=True)
        where = " and ".join(f"{name} from {low:g} to {high:g}" for name, (low, high) in pairs)
        inside = f"more than {1e3 * self.depth:g} mm of ground inside the track"
        limits = (
            "Motors have any torque; poses in which it would tip over from one wheel or two by "
            "itself are no rest, and rocking without rest is not excluded."
        )
        if (self.status == "certified").all():
            none = f"no equilibrium with running drives and {inside} exists for {where}"
            return f"certified: {none}; so it cannot come to rest there. {limits}"
        parts = [f"{self._percent('certified')} certified: no equilibrium with {inside}"]
        texts = {
            "as a belt": "where a belt can jam, too",
            "jams": f"where it can jam, as at {self._first_jam()}",
            "undecided": "undecided",
        }
        for status, text in texts.items():
            if (self.status == status).any():
                parts.append(f"{self._percent(status)} {text}")
        return f"{where}: {'; '.join(parts)}. {limits}"

    def _percent(self, status: str) -> str:
        """Write the fraction of a status; only everything is 100 %, and only nothing 0 %."""
        own = self.status == status
        percent = 100.0 * self.share(status)
        if percent > 99.5 and not own.all():
            return "more than 99 %"
        return "less than 1 %" if percent < 0.5 and own.any() else f"{percent:.0f} %"

    def _first_jam(self) -> str:
        """Write the values of the fields of the first jam, if any."""
        jams = self.witness[self.status == "jams"]
        values = jams[0] if len(jams) else ()
        pairs = zip(self.fields, values, strict=False)
        return ", ".join(f"{name} = {value:.4g}" for name, value in pairs)


def _label(path: str) -> str:
    attributes = field_attributes([path])
    unit = attributes.get("units", "1")
    return attributes["long_name"] + (f" [{unit}]" if unit not in ("", "1") else "")


@takes_keywords
def certify(
    scenario: Scenario,
    over: Mapping[str, tuple[float, float]],
    *,
    depth: float = 1e-3,
    smallest: float = 1.0 / 32.0,
    most_cells: int = 100_000,
    keep_cells: bool = False,
) -> Certificate:
    """Find ranges of height, friction and centre of mass in which a robot provably cannot jam.

    The space of all poses and field values is split into cells until each is excluded: a wheel
    overlaps the ground, nothing touches, no ground is inside the track, the weight does work on a
    virtual motion that no force resists, or the pose is unstable and tips over. All bounds come
    from interval arithmetic with a margin of 1e-9, far above rounding, so nothing between cells is
    missed; see docs/studies/jams.md. Poses tilted by more than `criteria.tip_over_angle` and poses
    at the ends of the ground are not considered. Where the robot can jam, the ranges are split into
    regions, and a belt round the same wheels is tested in each.

    Parameters
    ----------
    scenario : Scenario
        A robot on round wheels, with or without a belly, flippers held, before an obstacle that is
        the same under both tracks.
    over : mapping of str to pair of float
        Smallest and largest values of up to 4 fields that linearly change corners of the ground,
        its friction or the centre of mass: `terrain.height` of a step or a barrier,
        `terrain.friction`, `robot.center_of_mass[0]` and the like.
    depth : float
        [m] Smallest depth of ground inside the track of the excluded jams, above 0.
    smallest : float
        [-] Smallest region, as a fraction of each range, from 1/1024 to 1.
    most_cells : int
        A region that needs more cells is split or undecided; 1 to 10 million.
    keep_cells : bool
        Whether to return the cells.

    Returns
    -------
    Certificate
        Regions and their statuses.

    Raises
    ------
    ScenarioError
        If an argument breaks a rule, a field changes anything else, or there are no wheels, no
        friction or no speed.

    Examples
    --------
    Seven wheels cannot jam on steps up to 40 mm at usual frictions:

    >>> import crawler2d as c2d
    >>> robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(7))
    >>> base = c2d.Scenario(robot, c2d.terrains.step(0.1))
    >>> over = {"terrain.height": (0.02, 0.04), "terrain.friction": (0.6, 1.0)}
    >>> found = c2d.studies.certify(base, over)
    >>> found.holds
    True
    """
    names, ranges = _read(check_scenario(scenario), over)
    limit = real_number(depth, "depth")
    if not 0.0 < limit <= 1.0:
        raise ScenarioError("depth", limit, "must be > 0 m and <= 1 m")
    share = real_number(smallest, "smallest")
    if not 1.0 / 1024.0 <= share <= 1.0:
        raise ScenarioError("smallest", share, "must be >= 1/1024 and <= 1")
    most = whole_number(most_cells, "most_cells", 1, 10_000_000)
    keeps_cells = read_bool(keep_cells, "keep_cells")
    members = _members(scenario, names, ranges)
    found = _core.certify(
        [member.to_json() for member in members],
        [on_belt(member).to_json() for member in members],
        names,
        effort=(limit, share, most, keeps_cells),
    )
    return _certificate(names, ranges, limit, found, keeps_cells=keeps_cells)


def _read(
    scenario: Scenario, over: Mapping[str, tuple[float, float]]
) -> tuple[list[str], NDArray[np.float64]]:
    if not isinstance(over, Mapping) or not 1 <= len(over) <= _MOST_FIELDS:
        rule = f"must be a mapping of 1 to {_MOST_FIELDS} fields to pairs of numbers"
        raise ScenarioError("over", over, rule)
    ranges = []
    for name, pair in over.items():
        read_number_path(scenario, name, "over")
        ranges.append(read_range(pair, f"over[{name!r}]"))
    return list(over), np.array(ranges)


def _members(scenario: Scenario, names: list[str], ranges: NDArray[np.float64]) -> list[Scenario]:
    """Set the fields to their smallest values, one or all to the largest, and all half way."""
    low, high = ranges.T
    corners = [np.where(np.arange(len(names)) == k, high, low) for k in range(len(names))]
    rows = [low, *corners, high, 0.5 * (low + high)]
    return [scenario.replace(dict(zip(names, row.tolist(), strict=True))) for row in rows]


def _certificate(
    names: list[str],
    ranges: NDArray[np.float64],
    depth: float,
    found: dict[str, Any],
    *,
    keeps_cells: bool,
) -> Certificate:
    low, high = ranges.T
    count = found["count"]

    def scaled(shares: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(low + (high - low) * shares)

    shape = len(count), len(names)
    witness = np.full((len(count), len(names) + 3), np.nan)
    for row, seen in zip(witness, found["witnesses"], strict=True):
        if seen is not None:
            shares, pose = seen
            row[:] = *scaled(np.array(shares[: len(names)])), *pose
    cells = None
    if keeps_cells:
        columns = found["cells"]
        ends = [columns[end].reshape(-1, 3 + _MOST_FIELDS) for end in ("low", "high")]
        of_fields = slice(3, 3 + len(names))
        lows, highs = (np.hstack([end[:, :3], scaled(end[:, of_fields])]) for end in ends)
        exclusion = np.array(_EXCLUSIONS)[columns["exclusion"]]
        motion = columns["twist"].reshape(-1, 3) / (1.0, 1.0, found["length"])
        motion[exclusion != "unbalanced"] = np.nan
        cells = {"low": lows, "high": highs, "exclusion": exclusion, "motion": motion}
    return Certificate(
        fields=tuple(names),
        ranges=ranges,
        depth=depth,
        low=scaled(found["low"].reshape(shape)),
        high=scaled(found["high"].reshape(shape)),
        status=np.array([_STATUSES.get(int(k), "certified") for k in count]),
        witness=witness,
        count=np.maximum(count, 0),
        cells=cells,
    )
