"""Side view of a track: discs with a belt round them, and the grousers on the belt."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from crawler2d.common.arrays import read_rows, real_number
from crawler2d.common.bodies import Disc, end_discs, is_centered_pair, two_discs
from crawler2d.errors import ScenarioError
from crawler2d.parameters.fields import Parameters

__all__ = ["TrackOutline"]


@dataclass(frozen=True, slots=True, kw_only=True, init=False)
class TrackOutline(Parameters, path="robot.outline"):
    """Side view of the track: a taut belt round discs, measured to the grouser tips.

    Give two discs by `axle_distance`, `front_radius` and `rear_radius`; the origin of the chassis
    frame is then midway between their axles. Give any number by `discs`, in a chassis frame with
    its origin between the end axles, x forward along the chassis and y up.

    Parameters
    ----------
    discs : array_like, shape (n, 3)
        [m] Centre x and y in the chassis frame and radius of each of 2 to 64 discs, in any order.
        The track must bend round each: a disc inside the hull of the others is refused.
    axle_distance : float
        [m] Distance between the end axles along the chassis, at least 0.1 mm. The end axles are the
        centres of the discs that reach farthest back and forwards (the higher one if two reach
        equally far); the rear one carries the sprocket.
    front_radius, rear_radius : float
        [m] Radius of the disc on each end axle. The radii of two discs differ by less than their
        distance, or one would enclose the other.
    grouser_height : float
        [m] Height of the grousers above the belt, less than the smallest radius; 0 for a smooth
        belt.
    grouser_pitch : float
        [m] Spacing of the grousers along the belt.
    grouser_thickness : float
        [m] Thickness of a grouser along the belt, less than the pitch.

    Raises
    ------
    ScenarioError
        If `discs` does not hold real numbers, is masked, has another shape, or is given together
        with a distance or radius; if, without `discs`, one of those three is missing or not a
        number.

    Notes
    -----
    `axle_distance`, `front_radius` and `rear_radius` can be read from any outline. They can be
    replaced, by `dataclasses.replace` or by path, in an outline that they define fully.

    Examples
    --------
    >>> grousers = {"grouser_height": 0.01, "grouser_pitch": 0.05, "grouser_thickness": 0.006}
    >>> two = TrackOutline(axle_distance=0.4, front_radius=0.06, rear_radius=0.05, **grousers)
    >>> two == TrackOutline(discs=[(-0.2, 0, 0.05), (0.2, 0, 0.06)], **grousers)
    True

    With a raised idler in front:

    >>> raised = TrackOutline(discs=[*two.discs, (0.3, 0.08, 0.04)], **grousers)
    >>> raised.axle_distance, raised.front_radius
    (0.5, 0.04)
    """

    property_fields: ClassVar[tuple[str, ...]] = ("axle_distance", "front_radius", "rear_radius")

    discs: tuple[Disc, ...]
    if TYPE_CHECKING:
        # Properties that `dataclasses.replace` can set.
        axle_distance: float
        front_radius: float
        rear_radius: float
    grouser_height: float
    grouser_pitch: float
    grouser_thickness: float

    def __init__(
        self,
        *,
        discs: Any = None,
        axle_distance: float | None = None,
        front_radius: float | None = None,
        rear_radius: float | None = None,
        grouser_height: float,
        grouser_pitch: float,
        grouser_thickness: float,
    ) -> None:
        numbers = (axle_distance, front_radius, rear_radius)
        ends = dict(zip(self.property_fields, numbers, strict=True))
        given = {name: number for name, number in ends.items() if number is not None}
        fields = {
            "discs": _disc_pair(discs, given) if given or discs is None else discs,
            "grouser_height": grouser_height,
            "grouser_pitch": grouser_pitch,
            "grouser_thickness": grouser_thickness,
        }
        for name, value in fields.items():
            object.__setattr__(self, name, value)
        self.__post_init__()

    if not TYPE_CHECKING:

        @property
        def axle_distance(self) -> float:
            """[m] Distance between the end axles along the chassis."""
            rear, front = self.ends
            return front[0] - rear[0]

        @property
        def front_radius(self) -> float:
            """[m] Radius of the disc on the front end axle."""
            return self.ends[1][2]

        @property
        def rear_radius(self) -> float:
            """[m] Radius of the disc on the rear end axle."""
            return self.ends[0][2]

    @property
    def ends(self) -> tuple[Disc, Disc]:
        """[m] Centre (x, y) and radius of the disc on the rear and on the front end axle."""
        if not self.discs:
            raise ScenarioError("robot.outline.discs", self.discs, "must have at least 2 discs")
        return end_discs(self.discs)

    @property
    def written_as(self) -> dict[str, tuple[str, ...]]:
        """Write distance and radii instead of the discs, if they define the outline fully."""
        return {"discs": self.property_fields} if is_centered_pair(self.discs) else {}


def _disc_pair(discs: Any, given: dict[str, Any]) -> tuple[Disc, ...]:
    """Place two discs by distance and radii; missing ones are taken from `discs`."""
    values = given
    if discs is not None:  # `dataclasses.replace` gives both
        pair = read_rows(discs, "robot.outline.discs", rows=True, columns=3)
        if not is_centered_pair(pair):
            name, value = next(iter(given.items()))
            rule = "must not be given together with discs, which determine it"
            raise ScenarioError(f"robot.outline.{name}", value, rule)
        (_, _, rear), (half, _, front) = pair
        values = {"axle_distance": 2.0 * half, "front_radius": front, "rear_radius": rear, **given}
    numbers = {}
    for name in TrackOutline.property_fields:
        path = f"robot.outline.{name}"
        if name not in values:
            raise ScenarioError(path, None, "must be given unless discs are")
        numbers[name] = real_number(values[name], path)
    if not numbers["axle_distance"] > 0.0:  # the discs would not show it
        raise ScenarioError(
            "robot.outline.axle_distance", numbers["axle_distance"], "must be > 0 m"
        )
    return two_discs(numbers["axle_distance"], numbers["rear_radius"], numbers["front_radius"])
