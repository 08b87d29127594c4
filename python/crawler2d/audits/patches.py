"""Write a repair into the audited file, with a label that states the result."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.audits import words
from crawler2d.audits.repairs import Repair
from crawler2d.common.files import write_text
from crawler2d.errors import ScenarioError, ignore_warnings
from crawler2d.parameters.robot import Robot
from crawler2d.patching.patch import add_label, patch_file

if TYPE_CHECKING:
    from crawler2d.audits.record import AuditRecord

__all__ = ["Change", "best_change", "change_of", "diffs_of"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """A changed model file, or a new one instead.

    Parameters
    ----------
    text : str
        The whole text.
    label : str
        The change and its result; also the first comment of the text.
    diff : str
        Unified diff from the original file; "" for a new one.
    summary : str
        Size of the change.
    left : tuple of str
        Plugin settings to be adjusted by hand.
    suffix : str
        Suffix for another format; "" for the same one.
    """

    text: str
    label: str
    diff: str = ""
    summary: str
    left: tuple[str, ...] = ()
    suffix: str = ""

    def write(self, path: Path) -> Path:
        """Write the file, with `suffix` if it is set; return the path."""
        path = path.with_suffix(self.suffix) if self.suffix else path
        return write_text(path, self.text)


def best_change(audit: AuditRecord) -> Change | None:
    """Apply the best repair to the file; None if the robot does not seize.

    The best is the first confirmed one with wheels, else one with wheels that seizes less often
    than the file, else belts.

    Raises
    ------
    ScenarioError
        If there is no file, or none of these can be written.
    """
    _check(audit)
    if not audit.seizes:
        return None
    wheels = [each for each in audit.repairs if each.kind != "belt"]
    confirmed = [each for each in wheels if each.confirmed]
    unsure = [each for each in wheels if not each.confirmed]
    helping = [each for each in unsure if _after(audit, each) < _before(audit)]
    refused = []
    for repair in (*confirmed, *sorted(helping, key=lambda each: _after(audit, each))):
        try:
            return change_of(audit, repair)
        except ScenarioError as error:
            refused.append(f"{repair.description}: {error}")
    belts = next((each for each in audit.repairs if each.kind == "belt"), None)
    try:
        change = _on_belts(audit, audit.belt.robot, belts)
    except ScenarioError as error:
        refused.append(f"belts: {error}")
        rule = f"must be one that can be written to a file: {'; '.join(refused)}"
        raise ScenarioError("repair", "none", rule) from None
    if refused:
        change = replace(change, summary=f"{change.summary}; no wheels, for {'; '.join(refused)}")
    return change


def change_of(audit: AuditRecord, repair: Repair) -> Change:
    """Apply a repair to the audited file.

    Raises
    ------
    ScenarioError
        If there is no file, or its wheels are in a form that cannot be changed in place.
    """
    _check(audit)
    if repair.kind == "belt":
        return _on_belts(audit, repair.robot, repair)
    assert audit.reading is not None
    label = words.repair_sentence(repair)
    with ignore_warnings():  # they are in the lint
        patch = patch_file(audit.reading, repair.robot, f"crawler2d, {label}")
    return Change(
        text=patch.text, label=label, diff=patch.diff, summary=patch.summary, left=patch.left
    )


def diffs_of(audit: AuditRecord) -> dict[str, str]:
    """Return the diff, or why there is none, of each repair by wheels, by `Repair.description`."""
    found = {}
    for repair in audit.repairs if audit.reading is not None else ():
        if repair.kind != "belt":
            try:
                change = change_of(audit, repair)
                found[repair.description] = f"{change.summary}\n\n{change.diff}"
            except ScenarioError as error:
                found[repair.description] = f"no change of the file: {error}"
    return found


def _check(audit: AuditRecord) -> None:
    if audit.reading is None:
        rule = "must be the audit of a file; Robot.to_sdf, to_urdf and to_mjcf write other robots"
        raise ScenarioError("patch", "a Robot", rule)


def _on_belts(audit: AuditRecord, robot: Robot, repair: Repair | None) -> Change:
    """Write a new file of the robot on belts moved by a plugin of the simulator."""
    read = audit.reading
    assert read is not None
    if repair is None:
        worst = min(each.belt_cleared.rate for each in audit.verdicts if each.result == "seizes")
        label = f"not confirmed: belts moved by a track plugin ({audit.belt.reason})"
        label += f"; the belt cleared {words.percent(worst)} or more where the file seized"
    else:
        label = words.repair_sentence(repair)
    is_mjcf = read.tree.format == "MJCF"
    with ignore_warnings():  # they are in the lint
        text = (robot.to_mjcf if is_mjcf else robot.to_sdf)(friction=read.friction)
    note = "" if is_mjcf or read.tree.format.startswith("SDF") else ", because URDF holds no belts"
    return Change(
        text=add_label(text, f"crawler2d, {label}"),
        label=label,
        summary=f"a new {'MJCF' if is_mjcf else 'SDF'} file{note}",
        suffix=".sdf" if note else "",
    )


def _after(audit: AuditRecord, repair: Repair) -> float:
    """[-] Return the rate at which a repair seizes in fresh runs over the obstacles that seized."""
    names = [each.obstacle for each in audit.verdicts if each.result == "seizes"]
    return float(np.nanmean([repair.seized[name].rate for name in names]))


def _before(audit: AuditRecord) -> float:
    """[-] Return the rate at which the unchanged robot seizes there."""
    return float(np.mean([v.seized.rate for v in audit.verdicts if v.result == "seizes"]))
