"""Height of any terrain along x, read from the profiles that the core builds."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np

from crawler2d import _core
from crawler2d.common.bodies import Lane
from crawler2d.common.keywords import read_choice, takes_keywords
from crawler2d.errors import ScenarioError
from crawler2d.parameters.drivetrain import Drivetrain
from crawler2d.parameters.fields import Parameters
from crawler2d.parameters.outline import TrackOutline
from crawler2d.parameters.settings import Drive, ScenarioBase, Solver, Start
from crawler2d.parameters.track import BeltTrack

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = ["HasHeights"]

_Number = float | np.floating[Any] | np.integer[Any]
_Lane = Literal["left", "right", "middle"] | None
_LANES = {"left": Lane.LEFT, "right": Lane.RIGHT, "middle": Lane.MIDDLE}


@dataclass(frozen=True, slots=True, kw_only=True)
class _Grain(Parameters, path="robot"):
    """A 3 mm robot that fits anywhere: the core builds ground only for a robot."""

    gauge: float
    outline: TrackOutline
    drivetrain: Drivetrain
    name: str = "grain"
    mass: float = 1.0
    center_of_mass: tuple[float, float] = (0.0, 0.0)
    moment_of_inertia: float = 1.0
    track_mass: float = 0.1
    belly: None = None
    flippers: None = None
    track: BeltTrack = BeltTrack()


_GRAIN = _Grain(
    gauge=1.0,
    outline=TrackOutline(
        axle_distance=1e-3,
        front_radius=1e-3,
        rear_radius=1e-3,
        grouser_height=0.0,
        grouser_pitch=1e-3,
        grouser_thickness=5e-4,
    ),
    drivetrain=Drivetrain(
        max_speed=1.0, max_acceleration=1.0, max_deceleration=1.0, max_torque=1.0
    ),
)


class HasHeights(Parameters, path="terrain"):
    """Base of all terrains."""

    __slots__ = ()

    @property
    def _turn(self) -> float:
        """[rad] Yaw of the part that one track meets before the other."""
        return 0.0

    @overload
    def height_at(self, x: _Number, *, lane: _Lane = None, gauge: float | None = None) -> float: ...

    @overload
    def height_at(
        self, x: ArrayLike, *, lane: _Lane = None, gauge: float | None = None
    ) -> NDArray[np.float64]: ...

    @takes_keywords
    def height_at(
        self, x: ArrayLike, *, lane: _Lane = None, gauge: float | None = None
    ) -> float | NDArray[np.float64]:
        """Return the height of the ground as simulated, with rounded edges.

        Parameters
        ----------
        x : float or array_like
            [m] Positions along x.
        lane : {"left", "right", "middle"}, optional
            The ground under the left track, the right track or the belly. None requires the same
            ground under both tracks.
        gauge : float, optional
            [m] Distance between the robot's tracks, `Robot.gauge`. Needed only for barriers with a
            `yaw`.

        Returns
        -------
        float or ndarray
            [m] Height at each position, in the shape of `x`: the upper end of a vertical face, and
            NaN beyond the ends of the ground.

        Raises
        ------
        ScenarioError
            If the terrain breaks a rule, or leaves no room for a robot before its first edge; if
            `x` does not hold numbers; if the tracks are on different ground and `lane` is not
            given; if a turned barrier needs `gauge`.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> c2d.terrains.step(0.1).height_at([-0.5, 0.0, 0.5]).tolist()
        [0.0, 0.1, 0.1]
        >>> one_side = c2d.terrains.lanes(c2d.terrains.step(0.1), c2d.terrains.flat())
        >>> one_side.height_at(0.5, lane="left"), one_side.height_at(0.5, lane="right")
        (0.1, 0.0)
        """
        places = _read_places(x)
        profile = self._profile(lane, gauge)
        heights = _heights(profile, places)
        return float(heights) if heights.ndim == 0 else heights

    def _profile(self, lane: str | None, gauge: float | None) -> NDArray[np.float64]:
        """[m] Points of a lane from left to right, shape (n, 2)."""
        side = Lane.BOTH if lane is None else _LANES[read_choice(lane, "lane", list(_LANES))]
        if gauge is None and self._turn != 0.0:
            rule = "must be given (Robot.gauge): each track meets a turned barrier at another x"
            raise ScenarioError("gauge", None, rule)
        robot = _GRAIN if gauge is None else replace(_GRAIN, gauge=gauge)
        still: Any = {"drive": Drive(speed=0.0), "solver": Solver(time_step=1e-5)}
        text = ScenarioBase(robot, self, start=Start(approach=0.0), **still).to_json()
        lanes = dict(_core.geometry(text)["lanes"])
        if side is Lane.BOTH and side not in lanes:
            rule = f"must be one of {', '.join(_LANES)}, as the tracks are on different ground"
            raise ScenarioError("lane", None, rule)
        profile: NDArray[np.float64] = lanes[side if side in lanes else Lane.BOTH]
        return profile


def _read_places(x: ArrayLike) -> NDArray[np.float64]:
    try:
        places = np.asarray(x)
    except ValueError:  # rows of different lengths
        raise ScenarioError("x", x, "must be a number or an array of numbers") from None
    if places.dtype.kind not in "iuf":
        raise ScenarioError("x", x, f"must hold real numbers, not {places.dtype}")
    return places.astype(np.float64)


def _heights(profile: NDArray[np.float64], places: NDArray[np.float64]) -> NDArray[np.float64]:
    """[m] Heights of a line with non-decreasing x; the upper end where it is vertical."""
    x, y = profile.T
    heights = np.interp(places, x, y, left=np.nan, right=np.nan)
    corners, first = np.unique(x, return_index=True)
    tops = np.maximum.reduceat(y, first)
    near = np.searchsorted(corners, places).clip(max=len(corners) - 1)
    found: NDArray[np.float64] = np.where(corners[near] == places, tops[near], heights)
    return found
