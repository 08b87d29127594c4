"""What limits a figure, found by doing: the same runs again with one thing doubled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.parameters.paths import read_path

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.parameters.scenario import Scenario

__all__ = ["FRICTION", "TORQUE", "UNCHANGED", "Change", "limits"]

_FACTOR = 2.0


@dataclass(frozen=True, slots=True)
class Change:
    """What is doubled.

    Attributes
    ----------
    name : str
        Of the limit, such as "torque".
    paths : tuple of str
        The numbers that are doubled.
    meaning : str
        What it is, for the reader of a table.
    """

    name: str
    paths: tuple[str, ...] = ()
    meaning: str = ""

    @property
    def label(self) -> str:
        """Such as "torque x 2"."""
        return f"{self.name} x {_FACTOR:g}" if self.paths else self.name

    @property
    def factors(self) -> Mapping[str, float]:
        """[-] By path, for `Cell`."""
        return dict.fromkeys(self.paths, _FACTOR)

    def of(self, scenario: Scenario) -> Scenario:
        """Double these numbers of a scenario."""
        return scenario.replace({p: _FACTOR * read_path(scenario, p) for p in self.paths})


UNCHANGED = Change("unchanged")
TORQUE = Change("torque", ("robot.drivetrain.max_torque",), "robot.drivetrain.max_torque, an input")
FRICTION = Change("friction", ("terrain.friction",), "terrain.friction, an input")


def limits(
    values: NDArray[np.float64],
    changes: tuple[Change, ...],
    *,
    share: float,
    least: float,
    falls: bool = False,
) -> NDArray[np.str_]:
    """Name what limits a figure: what improves it when it is doubled, by more than chance does.

    Parameters
    ----------
    values : ndarray, shape (m, n, s, r)
        Of m models, n changes, s samples and r repeats; nan where there is no figure.
    changes : tuple of n Change
        The first is that nothing is changed.
    share : float
        [-] Share of the unchanged median by which a change must move it, at least.
    least : float
        In units of the figure, the same; less is no figure.
    falls : bool
        Whether lower is better, as of a braking distance.

    Returns
    -------
    ndarray of str, shape (m, s)
        Such as "torque", "command and friction", or "none of these". A change counts if the median
        over the repeats improves by more than these, and by more than the repeats without a change
        lie apart; where these have no figure, if there is one with the change.
    """
    medians = np.median(values, axis=-1)
    before = medians[:, :1]
    apart = np.ptp(values[:, :1], axis=-1)
    gain = (before - medians) if falls else (medians - before)
    needed = np.maximum(np.maximum(share * np.abs(before), apart), least)
    counts = np.where(np.isnan(before), np.isfinite(medians), gain > needed)
    names = np.array([change.name for change in changes])
    found = np.empty((values.shape[0], values.shape[2]), object)
    for model, sample in np.ndindex(found.shape):
        own = names[1:][counts[model, 1:, sample]]
        found[model, sample] = " and ".join(own) or "none of these"
    return found.astype(str)
