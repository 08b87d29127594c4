"""The paper's Table 2 over all drives: rates by motor torque, rotor inertia and friction."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from research.paper.fields import BESIDE_TABLE_2, cells, cross
from research.paper.joint import DriveCell, layouts_left
from research.paper.settings import Setting

if TYPE_CHECKING:
    from research.paper.design import Work

__all__ = ["Drives", "drive_cells"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Drives:
    """Which drives are tried, and how often."""

    torques: tuple[float, ...]
    """[N m] Of one sprocket."""
    inertias: tuple[float, ...]
    """[kg m^2] Of the rotor of one track, at its sprocket."""
    frictions: tuple[float, ...]
    """[-] Between track and ground."""
    runs: tuple[int, ...]
    """Runs a cell, by layout in the order of `BESIDE_TABLE_2`: gears that grind cost most."""
    most: int
    """Runs a cell wherever those above leave the drive in agreement with the paper."""

    def settings(self) -> list[Setting]:
        """List the drives at every friction, friction by friction."""
        return [
            Setting(
                name=f"{torque:g} N m, {inertia:g} kg m^2, friction {friction:g}",
                max_torque=torque,
                rotor_inertia=inertia,
                friction=friction,
                reason="a point of the chart",
            )
            for friction in self.frictions
            for torque in self.torques
            for inertia in self.inertias
        ]


def drive_cells(work: Work, drives: Drives) -> Iterator[list[DriveCell]]:
    """Drive the layouts of Table 2 over its fields with every drive.

    Yields
    ------
    list of DriveCell
        All cells so far, after every friction, and once more when the drives that are left have
        been tried more often.
    """
    found: dict[Setting, list[DriveCell]] = {}
    for friction in drives.frictions:
        for setting in drives.settings():
            if setting.friction == friction:
                found[setting] = _tried(work, setting, drives.runs)
        yield [cell for each in found.values() for cell in each]
    for setting, rows in found.items():
        if wanted := layouts_left(rows):
            runs = [
                max(count, drives.most) if model in wanted else count
                for model, count in zip(BESIDE_TABLE_2, drives.runs, strict=True)
            ]
            found[setting] = _tried(work, setting, runs)
    yield [cell for each in found.values() for cell in each]


def _tried(work: Work, setting: Setting, runs: Sequence[int]) -> list[DriveCell]:
    print(f"Table 2, {setting.name}", flush=True)
    return [
        DriveCell(
            torque=setting.max_torque,
            inertia=setting.rotor_inertia or 0.0,
            friction=setting.friction,
            obstacle=row.obstacle,
            model=row.model,
            cleared=row.cleared,
            count=row.count,
        )
        for model, count in zip(BESIDE_TABLE_2, runs, strict=True)
        for row in cells(setting, cross(setting, [model], work, count))
    ]
