"""The file of a robot with other wheels: the one door for all formats."""

from __future__ import annotations

import bisect
import difflib
import itertools
import re
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NoReturn

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Tree
from crawler2d.parameters.robot import Robot
from crawler2d.patching.changes import Change, changes_of
from crawler2d.patching.places import (
    change_mjcf,
    change_sdf,
    change_urdf,
    copied,
    items_about,
    names_of,
)
from crawler2d.reading.reading import Reading, read_text
from crawler2d.reading.tracks import FIT
from crawler2d.writing.document import Document, Span

__all__ = ["labelled", "patched"]

_FORMS: dict[str, Callable[[Document, Span, Change, Tree], None]] = {
    "SDF": change_sdf,
    "URDF": change_urdf,
    "MJCF": change_mjcf,
}

_SIZES = ("wheel_radius", "wheelRadius", "wheel_diameter", "wheelDiameter")
"""Settings of plugins that drive wheels by their speed."""

_COUNTS = ("num_wheel_pairs", "wheel_torque", "max_wheel_torque")
"""Settings of plugins that are right for a number of wheels only, and are not changed."""
_MASS = 1e-4  # of the whole: far above what rounding leaves
_CENTER = 0.01  # of the axle distance: wheels of unlike masses are spread anew


@dataclass(frozen=True, slots=True, kw_only=True)
class Patch:
    """A file with other wheels.

    Parameters
    ----------
    text : str
        All of it.
    diff : str
        What differs from the file that was read, as a unified diff.
    summary : str
        How many wheels were added, removed and changed, how many lines differ, and which settings
        of plugins that may depend on wheels stay as they are.
    left : tuple of str
        These settings, each with its line in the file that was read.
    """

    text: str
    diff: str
    summary: str
    left: tuple[str, ...]


def patched(reading: Reading, robot: Robot, label: str = "") -> Patch:
    """Change the wheels in the text of a file to those of another robot, and read that again.

    Parameters
    ----------
    reading : Reading
        What was read.
    robot : Robot
        The same robot with other wheels.
    label : str
        What stands at the top of the text, as a comment.

    Returns
    -------
    Patch
        Its robot, read by the keywords of `reading`, has the wheels of `robot`.

    Raises
    ------
    ScenarioError
        If the robots differ in more than wheels, or the text has them in a form that cannot be
        changed in place, such as meshes.
    """
    if "\ufffd" in reading.text:
        raise ScenarioError(reading.path.name, "another encoding", "must be UTF-8, to be changed")
    changes = changes_of(reading, robot)
    if not changes:
        raise ScenarioError("robot.track", robot.track, "must have other wheels than the file")
    document = Document(reading.text)
    _change(document, changes, reading.tree)
    text = labelled(document.text, label) if label else document.text
    _check(reading, robot, text)
    name = reading.tree.file
    diff = difflib.unified_diff(
        reading.text.splitlines(keepends=True),
        text.splitlines(keepends=True),
        name,
        f"{name} (other wheels)",
    )
    lines = list(diff)
    left = _left(changes, document.root, reading.text)
    summary = _summary(changes, lines, left)
    if reading.how.scale is not None:
        summary += f"; all lengths times {reading.how.scale:g}"
    return Patch(text=text, diff="".join(lines), summary=summary, left=left)


def labelled(text: str, label: str) -> str:
    r"""Put a comment at the top of an XML text, below its declaration.

    Examples
    --------
    >>> labelled("<?xml version='1.0'?>\n<robot/>", "five -- not four")
    "<?xml version='1.0'?>\n<!-- five - - not four -->\n<robot/>"
    """
    declaration = re.match(r"\s*<\?xml.*?\?>\s*", text, re.DOTALL)
    end = declaration.end() if declaration else 0
    line = "\r\n" if "\r\n" in text else "\n"
    return f"{text[:end]}<!-- {label.replace('--', '- -')} -->{line}{text[end:]}"


def _change(document: Document, changes: list[Change], tree: Tree) -> None:
    """Make all changes in a text."""
    change_wheel = _FORMS[tree.format.split()[0]]
    scope = _scope(document.root, tree)
    taken = {span.name for span in scope.within()}
    for change in changes:
        names = names_of(scope, change.links, change.joint.name)
        if change.fate == "changed":
            change_wheel(document, scope, change, tree)
            continue
        items = items_about(scope, names)
        if change.fate == "removed":
            for item in items:
                document.remove(item)
            continue

        def change_copies(copies: Document, root: Span, change: Change = change) -> None:
            change_wheel(copies, root, change, tree)

        new = _names(names, taken)
        texts = copied(document, items, new, change_copies)
        for item, text in zip(items, texts, strict=True):
            document.insert_after(item, text)
    _change_plugins(document, scope, changes)


def _scope(root: Span, tree: Tree) -> Span:
    """Return the element that holds the robot: of SDF its model."""
    if root.tag != "sdf":
        return root
    models = (each for each in root.within() if each.tag == "model" and each.name == tree.name)
    return next(models)


def _names(names: set[str], taken: set[str]) -> dict[str, str]:
    """Choose names for a copy, none of which is taken."""
    count = 1
    while True:
        suffix = "_added" if count == 1 else f"_added_{count}"
        new = {name: f"{name}{suffix}" for name in sorted(names)}
        if taken.isdisjoint(new.values()):
            taken.update(new.values())
            return new
        count += 1


def _change_plugins(document: Document, scope: Span, changes: list[Change]) -> None:
    """Change the radius by which a plugin turns a speed into that of wheels."""
    sizes = {change.joint.name: change.size for change in changes if change.fate == "changed"}
    for plugin in scope.within():
        if plugin.tag != "plugin":
            continue
        factors = {sizes[each.text] for each in plugin.within() if each.text in sizes}
        for setting in plugin.within():
            if setting.tag in _SIZES and len(factors) == 1:
                document.multiply(setting, list(factors))


def _check(reading: Reading, robot: Robot, text: str) -> None:
    """Read the new text, and hold it against the robot that it is to be."""
    path = reading.path
    if path.suffix == ".xacro":  # what it expanded to was changed
        path = path.with_suffix("") if path.stem.endswith(".urdf") else path.with_suffix(".urdf")
    again, _ = read_text(text.encode(), path, replace(reading.how, scale=None))
    made = again.robot
    got, asked = made.wheels(), robot.wheels()
    if len(got) != len(asked) or (got["carrier"] != asked["carrier"]).any():
        _fail("wheels", f"{len(got)} wheels", f"must have {len(asked)}")
    for name in ("x", "y", "radius"):
        off = np.abs(got[name] - asked[name])
        if off.max() > 2.0 * FIT:
            at = int(off.argmax())
            _fail(f"{name} of wheel {at}", float(got[name][at]), f"must be {asked[name][at]:.6g} m")
    if abs(made.mass - robot.mass) > _MASS * robot.mass:
        _fail("mass", made.mass, f"must be {robot.mass:.6g} kg")
    off_center = np.abs(np.subtract(made.center_of_mass, robot.center_of_mass)).max()
    if off_center > _CENTER * robot.outline.axle_distance:
        rule = (
            f"must not move by more than {_CENTER:.0%} of the axle distance, as it does because the"
            " wheels are heavy; Robot.to_sdf, to_urdf and to_mjcf write the robot anew"
        )
        _fail("center_of_mass", f"{1e3 * off_center:.3g} mm", rule)


def _fail(what: str, value: object, rule: str) -> NoReturn:
    raise ScenarioError(f"the changed file, read again: {what}", value, rule)


def _left(changes: list[Change], root: Span, text: str) -> tuple[str, ...]:
    """List the settings of plugins that may no longer be right for so many wheels."""
    fates = _fates(changes)
    if fates["added"] == fates["removed"]:
        return ()
    lines = text.encode().splitlines(keepends=True)
    ends = list(itertools.accumulate(map(len, lines)))
    return tuple(
        f"{setting.tag} in line {bisect.bisect(ends, setting.start) + 1} is still {setting.text}"
        for plugin in root.within()
        if plugin.tag == "plugin"
        for setting in plugin.within()
        if setting.tag in _COUNTS
    )


def _fates(changes: list[Change]) -> Counter[str]:
    """Count what becomes of wheels."""
    return Counter(change.fate for change in changes if not change.is_none)


def _summary(changes: list[Change], diff: list[str], left: tuple[str, ...]) -> str:
    """Say what becomes of the wheels, and what is left to be set by hand."""
    fates = _fates(changes)
    parts = [f"{fates[fate]} {fate}" for fate in ("added", "removed", "changed") if fates[fate]]
    marks = Counter(line[0] for line in diff[2:])
    text = f"wheels: {', '.join(parts)}; lines: {marks['+']} new, {marks['-']} gone"
    more = fates["added"] - fates["removed"]
    hint = f" (there are {abs(more)} wheels {'more' if more > 0 else 'fewer'})"
    return f"{text}; to be set by hand{hint}: {', '.join(left)}" if left else text
