"""A model file with the wheels of another robot, in any format."""

from __future__ import annotations

import bisect
import difflib
import itertools
import re
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import NoReturn

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Tree
from crawler2d.parameters.robot import Robot
from crawler2d.patching.changes import Change, changes_of
from crawler2d.patching.edits import (
    change_mjcf,
    change_sdf,
    change_urdf,
    copy_elements,
    items_about,
    names_of,
)
from crawler2d.reading.reading import Reading, read_text
from crawler2d.reading.sdf import SCOPE
from crawler2d.reading.tracks import FIT
from crawler2d.writing.document import Document, Span

__all__ = ["add_label", "patch_file"]

_EDITORS: dict[str, Callable[[Document, Span, Change, Tree], None]] = {
    "SDF": change_sdf,
    "URDF": change_urdf,
    "MJCF": change_mjcf,
}

_SIZES = ("wheel_radius", "wheelRadius", "wheel_diameter", "wheelDiameter")
"""Plugin settings with the radius of driven wheels."""

_COUNTS = ("num_wheel_pairs", "wheel_torque", "max_wheel_torque")
"""Plugin settings that depend on the number of wheels, and are not changed."""

_MARK = "\0"  # between a name and a line; not in any file
_ALIKE = 1e-3  # [-] Largest difference of wheel sizes with one plugin setting.
_MASS = 1e-4  # of the whole: far above rounding
_MOTORS = 0.01  # [-] of torques, rotors and gains
_CENTER = 0.01  # of the axle distance: the masses of unequal wheels are redistributed


@dataclass(frozen=True, slots=True, kw_only=True)
class Patch:
    """A file with other wheels.

    Parameters
    ----------
    text : str
        The whole text.
    diff : str
        The differences from the file that was read, as a unified diff.
    summary : str
        Numbers of added, removed and changed wheels and of changed lines, and plugin settings that
        may depend on wheels but are unchanged.
    left : tuple of str
        These settings, each with its line in the file that was read.
    """

    text: str
    diff: str
    summary: str
    left: tuple[str, ...]


def patch_file(reading: Reading, robot: Robot, label: str = "") -> Patch:
    """Change the wheels in the text of a file to those of another robot, and read it again.

    Parameters
    ----------
    reading : Reading
        The reading of the file.
    robot : Robot
        The same robot with other wheels.
    label : str
        A comment at the top of the text.

    Returns
    -------
    Patch
        The file; read with the keywords of `reading`, it has the wheels of `robot`.

    Raises
    ------
    ScenarioError
        If the robots differ in more than wheels, or the wheels are in a form that cannot be changed
        in place, such as meshes.
    """
    if "\ufffd" in reading.text:
        raise ScenarioError(reading.path.name, "another encoding", "must be UTF-8, to be changed")
    changes = changes_of(reading, robot)
    if not changes:
        raise ScenarioError(
            "robot.track", robot.track, "must have wheels that differ from the file's"
        )
    document = Document(reading.text)
    unlike = _edit(document, changes, reading)
    text = add_label(document.text, label) if label else document.text
    _check(reading, robot, text)
    lines = _diff(reading.text, text, reading.tree.file)
    left = _left(changes, document.root, reading.text, unlike)
    summary = _summary(changes, lines, left)
    if reading.how.scale is not None:
        summary += f"; all lengths times {reading.how.scale:g}"
    return Patch(text=text, diff="".join(lines), summary=summary, left=left)


def add_label(text: str, label: str) -> str:
    r"""Put a comment at the top of an XML text, below its declaration.

    Examples
    --------
    >>> add_label("<?xml version='1.0'?>\n<robot/>", "five -- not four, on a---b")
    "<?xml version='1.0'?>\n<!-- five - - not four, on a- - -b -->\n<robot/>"
    """
    # A byte order mark, as written by Windows editors, must stay the first character.
    begin = re.match(r"\ufeff?(?:\s*<\?xml.*?\?>\s*)?", text, re.DOTALL)
    end = begin.end() if begin else 0
    line = "\r\n" if "\r\n" in text else "\n"
    return f"{text[:end]}<!-- {re.sub('-(?=-)', '- ', label)} -->{line}{text[end:]}"


def _edit(document: Document, changes: list[Change], reading: Reading) -> list[Span]:
    """Make all changes in a text; return plugin settings that now cover several sizes."""
    tree = reading.tree
    change_wheel = _EDITORS[tree.format.split()[0]]
    scope = document.root
    if scope.tag == "sdf":  # its model, perhaps one of several
        models = (each for each in scope.within() if each.tag == "model" and each.name == tree.name)
        scope = next(models)
        for change in changes:
            if SCOPE in change.link:
                rule = (
                    "must be in the model itself, not in one inside it, to be changed in the text"
                )
                raise ScenarioError(f"link[{change.link}]", "a nested model", rule)
    taken = {span.name for span in scope.within()}
    for change in changes:
        if change.action == "changed":
            change_wheel(document, scope, change, tree)
            continue
        names = names_of(scope, change.links, change.joint.name)
        items = items_about(scope, names)
        if change.action == "removed":
            for item in items:
                document.remove(item)
            continue

        def change_copies(copies: Document, root: Span, change: Change = change) -> None:
            change_wheel(copies, root, change, tree)

        texts = copy_elements(document, items, _new_names(names, taken), change_copies)
        for item, text in zip(items, texts, strict=True):
            document.insert_after(item, text)
    joints = [tree.joints[name].name for name in reading.wheels["name"].tolist()]
    return _change_plugins(document, scope, _factors(changes, joints))


def _new_names(names: set[str], taken: set[str]) -> dict[str, str]:
    """Choose unused names for a copy."""
    for count in itertools.count(1):
        suffix = "_added" if count == 1 else f"_added_{count}"
        new = {name: f"{name}{suffix}" for name in sorted(names)}
        if taken.isdisjoint(new.values()):
            break
    taken.update(new.values())
    return new


def _factors(changes: list[Change], joints: Iterable[str]) -> dict[str, set[float]]:
    """Return the factors of the sizes of each wheel of the file and of its copies, by its joint."""
    factors = {name: {1.0} for name in joints}
    for change in changes:
        if change.action != "added":
            factors[change.joint.name] = {change.size} if change.action == "changed" else set()
    for change in changes:
        if change.action == "added":
            factors[change.joint.name].add(change.size)
    return factors


def _change_plugins(
    document: Document, scope: Span, factors: Mapping[str, set[float]]
) -> list[Span]:
    """Change the radius by which a plugin converts a speed to that of wheels.

    If wheels get different radii, one setting cannot fit all of them: it is kept and returned.
    """
    unlike = []
    for plugin in scope.within():
        if plugin.tag != "plugin":
            continue
        driven = [factors[each.text] for each in plugin.within() if each.text in factors]
        sizes = sorted(set().union(*driven))
        for setting in plugin.within():
            if setting.tag not in _SIZES or not sizes:
                continue
            if sizes[-1] - sizes[0] > _ALIKE:
                unlike.append(setting)
            else:
                document.multiply(setting, sizes[-1:])
    return unlike


def _check(reading: Reading, robot: Robot, text: str) -> None:
    """Read the new text, and compare it with the robot."""
    path = reading.path
    if path.suffix == ".xacro":  # its expansion was changed
        path = path.with_suffix("") if path.stem.endswith(".urdf") else path.with_suffix(".urdf")
    try:
        again, _ = read_text(text.encode(), path, replace(reading.how, scale=None))
    except ScenarioError as error:  # about a text that the author has not seen
        _fail(error.path, error.value, error.rule)
    got, asked = again.robot.wheels(), robot.wheels()
    if len(got) != len(asked) or (got["carrier"] != asked["carrier"]).any():
        _fail("wheels", f"{len(got)} wheels", f"must have {len(asked)}")
    for name in ("x", "y", "radius"):
        off = np.abs(got[name] - asked[name])
        if off.max() > 2.0 * FIT:
            at = int(off.argmax())
            _fail(f"{name} of wheel {at}", float(got[name][at]), f"must be {asked[name][at]:.6g} m")
    if abs(again.robot.mass - robot.mass) > _MASS * robot.mass:
        _fail("mass", again.robot.mass, f"must be {robot.mass:.6g} kg")
    off_center = np.abs(np.subtract(again.robot.center_of_mass, robot.center_of_mass)).max()
    if off_center > _CENTER * robot.outline.axle_distance:
        rule = (
            f"must not move by more than {_CENTER:.0%} of the axle distance, as it does because the"
            " wheels are heavy; Robot.to_sdf, to_urdf and to_mjcf write a new file"
        )
        _fail("center_of_mass", f"{1e3 * off_center:.3g} mm", rule)
    _check_motors(reading.robot, again.robot)


def _check_motors(before: Robot, after: Robot) -> None:
    """Refuse wheels with another total force, or other rotors or gains."""
    radius, own = after.outline.rear_radius, before.outline.rear_radius
    names = {"max_torque": 1, "rotor_inertia": 2, "controller.gain": 2}
    for name, power in names.items():
        asked, got = (_read_figure(each, name) for each in (before, after))
        asked *= (radius / own) ** power
        if abs(got - asked) > _MOTORS * max(abs(asked), abs(got)):
            rule = (
                f"must be {asked:.6g}, that of all wheels of the file together; it may be that of a"
                " class there, or of motors that differ"
            )
            _fail(f"robot.drivetrain.{name}", float(f"{got:.6g}"), rule)


def _read_figure(robot: Robot, name: str) -> float:
    motors = robot.drivetrain
    if name == "controller.gain":
        return 0.0 if motors.controller is None else motors.controller.gain
    return float(getattr(motors, name))


def _fail(what: str, value: object, rule: str) -> NoReturn:
    raise ScenarioError(f"the changed file, read again: {what}", value, rule)


def _diff(old: str, new: str, name: str) -> list[str]:
    """List the lines of a unified diff of two texts of a file."""
    # Mark lines that occur in every link, so that wheels are not confused.
    before, after = (_marked(text.splitlines(keepends=True)) for text in (old, new))
    marked = difflib.unified_diff(before, after, name, f"{name} (other wheels)")
    lines = [line[0] + line.partition(_MARK)[2] if _MARK in line else line for line in marked]
    is_changed = [line[0] in "-+" for line in lines]
    for start in range(len(lines) - 1, 2, -1):
        if is_changed[start] and not is_changed[start - 1]:
            _join_ends(lines, start)
    return lines


def _join_ends(lines: list[str], start: int) -> None:
    """Join equal lines at the ends of removed and added blocks: only their marks differ."""
    middle = _end_of_run(lines, start, "-")
    end = _end_of_run(lines, middle, "+")
    gone, new = lines[start:middle], lines[middle:end]
    same: list[str] = []
    while gone and new and gone[-1][1:] == new[-1][1:]:
        gone.pop()
        same.insert(0, f" {new.pop()[1:]}")
    lines[start:end] = [*gone, *new, *same]


def _end_of_run(lines: list[str], start: int, sign: str) -> int:
    end = start
    while end < len(lines) and lines[end].startswith(sign):
        end += 1
    return end


def _marked(lines: list[str]) -> list[str]:
    """Prefix each line with the last name in or above it."""
    name, marked = "", []
    for line in lines:
        named = re.search(r"""\b(?:name|reference)\s*=\s*["']([^"']*)""", line)
        name = named[1] if named else name
        marked.append(f"{name}{_MARK}{line}")
    return marked


def _left(
    changes: list[Change], root: Span, text: str, unlike: Collection[Span] = ()
) -> tuple[str, ...]:
    """List plugin settings and keyframes that may be wrong for more, fewer or different wheels.

    Parameters
    ----------
    changes : list of Change
        Changes of the wheels.
    root : Span
        The text that was read.
    text : str
        That text.
    unlike : collection of Span
        Its size settings that now cover several sizes.
    """
    counts = _counts(changes)
    other = [change for change in changes if change.action != "changed"]
    names = {name for change in other for name in (change.joint.name, *change.links)}
    lines = text.encode().splitlines(keepends=True)
    ends = list(itertools.accumulate(map(len, lines)))
    plugins = [each for each in root.within() if each.tag == "plugin"]
    frames = [each for frame in root.all("keyframe") for each in frame.all("key") if names]
    left = []
    for frame in frames:
        line = bisect.bisect(ends, frame.start) + 1
        left.append(f"key in line {line} still has numbers for the joints of before")
    for setting in (each for plugin in plugins for each in plugin.within()):
        line = bisect.bisect(ends, setting.start) + 1
        if setting in unlike:
            why = ", for wheels of several sizes"
        elif setting.tag in _COUNTS and counts["added"] != counts["removed"]:
            why = ""
        elif _lists(setting, names):
            why = ", a list with wheels that are added or removed"
        else:
            continue
        value = " ".join(setting.text.split())
        left.append(f"{setting.tag} in line {line} is still {value}{why}")
    return tuple(left)


def _lists(setting: Span, names: set[str]) -> bool:
    """Whether a setting's text contains one of these names among others."""
    is_one = setting.children or setting.text in names
    return not is_one and not names.isdisjoint(re.split(r"""[\s,;'"()[\]]+""", setting.text))


def _counts(changes: list[Change]) -> Counter[str]:
    """Count the wheels by action."""
    return Counter(change.action for change in changes if not change.is_none)


def _summary(changes: list[Change], diff: list[str], left: tuple[str, ...]) -> str:
    """Describe the changes of the wheels, and settings to be adjusted by hand."""
    counts = _counts(changes)
    parts = [f"{counts[each]} {each}" for each in ("added", "removed", "changed") if counts[each]]
    marks = Counter(line[0] for line in diff[2:])
    text = f"wheels: {', '.join(parts)}; lines: {marks['+']} new, {marks['-']} gone"
    more = counts["added"] - counts["removed"]
    hint = f" (there are {abs(more)} wheels {'more' if more > 0 else 'fewer'})" if more else ""
    return f"{text}; to be set by hand{hint}: {', '.join(left)}" if left else text
