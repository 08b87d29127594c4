"""The audited file with the wheels of a repair."""

from __future__ import annotations

from typing import TYPE_CHECKING

from crawler2d.audits.repairs import Repair
from crawler2d.errors import ScenarioError
from crawler2d.patching.patch import Patch, patched

if TYPE_CHECKING:
    from crawler2d.audits.audited import Audited

__all__ = ["diffs_of", "patch_of"]


def patch_of(audit: Audited, repair: Repair | None) -> Patch:
    """Put the wheels of a repair into the file that was audited.

    Parameters
    ----------
    audit : Audited
        Of a file.
    repair : Repair, optional
        One of its repairs; None takes the first that is confirmed and not of belts.

    Raises
    ------
    ScenarioError
        If no file was read, there is no such repair, or the text has wheels in a form that cannot
        be changed in place.
    """
    if audit.reading is None:
        rule = "must be the audit of a file; Robot.to_sdf, to_urdf and to_mjcf write other robots"
        raise ScenarioError("patch", "a Robot", rule)
    if repair is None:
        held = (each for each in audit.repairs if each.confirmed and each.kind != "belt")
        repair = next(held, None)
    if repair is None:
        rule = (
            "must be given, where no change of wheels is confirmed: one of Audit.repairs that is"
            " not; belts are written by repair.robot.to_sdf or to_mjcf"
        )
        raise ScenarioError("repair", "none that is confirmed", rule)
    if repair.kind == "belt":
        rule = "must be other wheels or gears: write belts with repair.robot.to_sdf or to_mjcf"
        raise ScenarioError("repair", repair.what, rule)
    return patched(audit.reading, repair.robot)


def diffs_of(audit: Audited) -> dict[str, str]:
    """Say what each repair by wheels changes in the file, or why it cannot, by `Repair.what`."""
    found = {}
    for repair in audit.repairs if audit.reading is not None else ():
        if repair.kind != "belt":
            try:
                patch = patch_of(audit, repair)
                found[repair.what] = f"{patch.summary}\n\n{patch.diff}"
            except ScenarioError as error:
                found[repair.what] = f"no change of the file: {error}"
    return found
