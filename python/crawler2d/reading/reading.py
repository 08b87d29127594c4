"""Read a robot from a public model file, whatever format it has."""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

from crawler2d.common.arrays import Table, is_iterable, real_number
from crawler2d.common.keywords import takes_keywords
from crawler2d.drawings.svg import table
from crawler2d.errors import ScenarioError, ScenarioWarning, warn
from crawler2d.model_tree import Pose, Tree
from crawler2d.parameters.robot import Robot
from crawler2d.reading.assembly import Assembly, Silhouette, assemble, silhouettes
from crawler2d.reading.engines import ENGINES, Engine
from crawler2d.reading.files import Files
from crawler2d.reading.loading import TOLERANCE, ReadOptions, load_model
from crawler2d.reading.log import Sources, add_warnings, lines, span
from crawler2d.reading.meshes import MeshRule
from crawler2d.reading.surfaces import refuse_unread

__all__ = ["Reading", "read_robot", "read_text"]

_SHOWN = 12  # wheels in the text of a reading


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Reading:
    """The robot read from a model file.

    Parameters
    ----------
    robot : Robot
        The robot, in side view.
    friction : float
        [-] Friction between its tracks and the ground, by the rule of `engine`.
    sources : Sources
        Source of every figure of the robot: file and lines, or "estimate" with its rule.
    wheels : Table
        One row for each wheel and each drum of a moved track: `side`, `carrier`, `name`, `x`, `y`
        and `z` [m] (in the frame of the model: forward, up and to the left), `radius` [m], `mass`
        [kg] of the turning parts, `line`.
    notes : tuple of str
        Decisions made while reading, in words.
    warnings : tuple of str
        Probable mistakes, in words; each was also issued as a `ScenarioWarning`.
    engine : str
        The engine whose rules for friction and motors apply.
    tree : Tree
        Links, joints and collision shapes of the file.
    silhouettes : tuple of Silhouette
        Its collision shapes in side view, in the frame of the robot's chassis.
    text : str
        The text to which lines refer: the file, or the expansion of a xacro file.
    frame : Pose
        The chassis frame in the frame of the model: x forward through the end axles, y to the left,
        z up.
    path : Path
        Path of the file.
    how : ReadOptions
        The keywords used.
    """

    robot: Robot
    friction: float
    sources: Sources
    wheels: Table
    notes: tuple[str, ...]
    warnings: tuple[str, ...]
    engine: str
    tree: Tree
    silhouettes: tuple[Silhouette, ...]
    text: str
    frame: Pose
    path: Path
    how: ReadOptions

    @property
    def description(self) -> str:
        """A short description, for titles."""
        return (
            f"{self.robot.description}; {self.robot.mass:.4g} kg,"
            f" friction {self.friction:.3g} ({self.tree.format}, {self.tree.file})"
        )

    @takes_keywords
    def friction_on(self, ground: float) -> float:
        """[-] Return the friction on ground with another coefficient, by the rule of `engine`.

        Raises
        ------
        ScenarioError
            If it is not a valid coefficient, or the friction differs between wheels.
        """
        ReadOptions(ground_friction=real_number(ground, "ground"))  # checks its bounds
        _, friction, _ = assemble(
            self.tree,
            forward=self.how.forward,
            tolerance=self.how.tolerance,
            engine=self.engine,
            ground=ground,
        )
        return friction

    def __repr__(self) -> str:
        """Write the robot, its wheels, notes and warnings."""
        columns = [self.wheels[name].tolist() for name in ("side", "carrier", "x", "y", "radius")]
        lines = [
            f"{side} {carrier}: x {x:.4f} m, y {y:.4f} m, radius {radius:.4f} m"
            for side, carrier, x, y, radius in zip(*columns, strict=True)
        ]
        if len(lines) > _SHOWN:
            lines[_SHOWN:] = [f"and {len(lines) - _SHOWN} more: see .wheels"]
        rows = [self.description, *(f"  {line}" for line in lines)]
        rows += [f"  note: {note}" for note in self.notes]
        rows += [f"  warning: {warning}" for warning in self.warnings]
        rows.append(f"  estimates: {', '.join(self.sources.estimates)}")
        return "\n".join(rows)

    def _repr_html_(self) -> str:
        """Show the robot with the sources of its figures in a notebook."""
        card = self.robot._repr_html_() or ""
        return card + table(self.sources.items())


@takes_keywords
def read_robot(
    path: str | os.PathLike[str],
    engine: Engine | None = None,
    *,
    forward: Literal["+x", "-x", "+y", "-y"] | None = None,
    model: str | None = None,
    mesh: MeshRule = "hull",
    missing: Literal["leave_out", "refuse"] = "leave_out",
    tracks: Collection[str] = (),
    ground_friction: float | None = None,
    tolerance: float = TOLERANCE,
    scale: float | None = None,
    trusted: bool = False,
    packages: Mapping[str, str | os.PathLike[str]] | None = None,
    arguments: Mapping[str, str] | None = None,
) -> Reading:
    """Read a robot from a model file of another simulator: SDF, URDF, xacro or MJCF.

    Parts that a side view cannot represent are refused by name: differences between the sides,
    suspension, steering, friction that differs between wheels. The rules are in
    ``docs/conventions.md``, "Reading a model file".

    Parameters
    ----------
    path : str or PathLike
        Model file; the name of a xacro file is ``*.xacro``.
    engine : {"gz", "classic", "bullet", "mujoco", "isaac"}, optional
        The simulator whose rules apply: gz-sim with DART, Gazebo Classic with ODE, PyBullet, MuJoCo
        or Isaac Sim; none of them is run. It determines how the friction of two surfaces is
        combined, the effect of a commanded speed (a note of the reading), and which figures of a
        joint count, such as rotor inertia, with warnings for those that it ignores.
        ``docs/conventions.md``, "Reading a model file", has the rules and their sources. None takes
        "mujoco" for MJCF and "gz" for other formats.
    forward : {"+x", "-x", "+y", "-y"}, optional
        Forward direction of the model. None takes the side of the links called front, or else +x;
        if that is ambiguous, it must be given.
    model : str, optional
        Name of the model in a world; None takes the only movable one.
    mesh : {"refuse", "hull", "leave_out"}
        What to do with collision meshes. "hull" takes the convex hull of meshes with a readable
        file (.dae, .stl, .obj, .glb or .gltf), and leaves out others with a warning. "leave_out"
        leaves all out, "refuse" refuses them. A model is always refused if its wheels or tracks
        would be left out.
    missing : {"leave_out", "refuse"}
        What to do with missing parts: includes, undefined macros, joints of missing links.
        "leave_out" leaves them out, with a warning each; files of a missing package are then found
        by their path, and arguments without a value by a setting in the package.
    tracks : collection of str
        Links with surfaces that move by means outside the file, such as a controller in Isaac.
    ground_friction : float, optional
        [-] Coefficient of the ground's own surface. None takes the engine's default: 1.0, or 0.5 in
        Isaac and Bullet. That of a world in the file is not used; a note has it.
    tolerance : float
        [m] Largest difference between the two sides in side view.
    scale : float, optional
        [-] Factor of every length in an SDF or URDF file, and, squared, of moments of inertia:
        0.001 for a file in millimetres. `Audit.patch` writes the scaled file.
    trusted : bool
        Whether a xacro file may evaluate any expression and read the environment. Otherwise only
        plain data, operators and known functions are evaluated, which is enough for most files.
    packages : mapping of str to path, optional
        Folders of packages named by ``$(find ...)``, ``package://`` and ``model://``. They take
        precedence over those found by the search described in ``docs/conventions.md``.
    arguments : mapping of str to str, optional
        Values for the arguments of a xacro file; they take precedence over settings of its package.

    Returns
    -------
    Reading
        The robot with its friction, and the source of every figure.

    Raises
    ------
    ScenarioError
        If the file cannot be read, breaks a rule of its format, or contains something that a side
        view cannot represent. The error names file, line and element; its notes list what was left
        out before.
    ImportError
        If the library for xacro, MJCF or meshes is missing; the message names the extra to install.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import crawler2d as c2d
    >>> body = '''
    ... <link name="{name}">
    ...   <inertial><mass value="{mass}"/>
    ...     <inertia ixx="0.1" ixy="0" ixz="0" iyy="{inertia}" iyz="0" izz="0.1"/></inertial>
    ...   <collision><origin rpy="1.5707963267948966 0 0"/><geometry>{shape}</geometry></collision>
    ... </link>'''
    >>> joint = '''
    ... <joint name="{name}_joint" type="continuous">
    ...   <parent link="hull"/><child link="{name}"/><origin xyz="{x} {y} 0"/><axis xyz="0 1 0"/>
    ...   <limit effort="5" velocity="10"/>
    ... </joint>'''
    >>> box, disc = '<box size="0.4 0.05 0.2"/>', '<cylinder radius="0.08" length="0.05"/>'
    >>> text = "<robot name='cart'>" + body.format(name="hull", mass=8, inertia=0.2, shape=box)
    >>> for name, x, y in (("a", 0.2, 0.2), ("b", -0.2, 0.2), ("c", 0.2, -0.2), ("d", -0.2, -0.2)):
    ...     text += body.format(name=name, mass=1, inertia=0.003, shape=disc)
    ...     text += joint.format(name=name, x=x, y=y)
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "cart.urdf"
    >>> _ = path.write_text(text + "</robot>")
    >>> reading = c2d.read_robot(path)
    >>> reading.robot.mass, reading.robot.outline.axle_distance, reading.friction
    (12.0, 0.4, 1.0)
    >>> print(reading.sources["robot.outline.front_radius"])
    cart.urdf:10, 28
    >>> run = c2d.simulate(reading.robot, c2d.terrains.step(0.03, friction=reading.friction))
    >>> str(run.outcome)
    'cleared'
    """
    if not isinstance(path, (str, os.PathLike)):
        raise ScenarioError("path", path, "must be a path")
    if isinstance(path, str) and path.lstrip().startswith("<"):
        raise ScenarioError("path", path, "must be a path; write the text of a model to a file")
    if isinstance(tracks, str) or not isinstance(tracks, Collection) or not is_iterable(tracks):
        raise ScenarioError("tracks", tracks, "must be a collection of names of links")
    options = ReadOptions(
        engine=engine,
        forward=forward,
        model=model,
        mesh=mesh,
        missing=missing,
        tracks=tuple(tracks),
        ground_friction=ground_friction,
        tolerance=tolerance,
        scale=scale,
        trusted=trusted,
        packages={} if packages is None else packages,
        arguments={} if arguments is None else arguments,
    )
    path = Path(path)
    reading, warnings = read_text(Files(path, options.packages).model(), path, options)
    for warning in warnings:
        warn(warning.path, warning.value, warning.reason)
    return reading


def read_text(
    data: bytes, path: Path, options: ReadOptions
) -> tuple[Reading, list[ScenarioWarning]]:
    """Read a robot from the content of a file, like `read_robot` without issuing warnings.

    Parameters
    ----------
    data : bytes
        The content.
    path : Path
        Path of the file, which need not exist.
    options : ReadOptions
        The keywords of `read_robot`.

    Returns
    -------
    Reading and list of ScenarioWarning
        The reading, and probable mistakes.
    """
    loaded = load_model(data, path, options)
    for name in options.tracks:
        if not isinstance(name, str) or name not in loaded.tree.by_name:
            raise ScenarioError("tracks", name, "must be links of the model")
    tree = replace(loaded.tree, tracks=tuple(options.tracks))
    refuse_unread(tree)
    engine = options.engine or ("mujoco" if tree.format == "MJCF" else "gz")
    ground = options.ground_friction
    if ground is None:
        ground = ENGINES[engine].usual_friction
    with add_warnings(loaded.warnings):
        robot, friction, work = assemble(
            tree, forward=options.forward, tolerance=options.tolerance, engine=engine, ground=ground
        )
    robot.wheels()  # the core checks every rule of a robot
    warnings = [ScenarioWarning(*warning) for warning in [*loaded.warnings, *work.log.warnings]]
    unused = [(friction, at) for friction, at in tree.floors if friction != ground]
    if unused:
        value = span([friction for friction, _ in unused])
        work.log.notes.append(
            f"{lines([at for _, at in unused])}: the ground in the file has a friction of {value},"
            f" which is not used: here it has {ground:g}; ground_friction= sets that"
        )
    if path.suffix == ".xacro":
        work.log.notes.append(
            f"lines are those of the text that {path.name} expands to, Reading.text"
        )
    reading = Reading(
        robot=robot,
        friction=friction,
        sources=Sources(work.log.sources),
        wheels=_wheel_table(work),
        notes=tuple(work.log.notes),
        warnings=tuple(str(warning) for warning in warnings),
        engine=engine,
        tree=tree,
        silhouettes=silhouettes(tree, work.view, work.base),
        text=loaded.text,
        frame=work.frame,
        path=path,
        how=options,
    )
    return reading, warnings


def _wheel_table(work: Assembly) -> Table:
    rows = work.log.rows
    columns: dict[str, Any] = {
        "side": ["left" if runner.z > work.view.middle else "right" for _, runner in rows],
        "carrier": [carrier for carrier, _ in rows],
    }
    for name in ("name", "x", "y", "z", "radius", "mass"):
        columns[name] = [getattr(runner, name) for _, runner in rows]
    columns["line"] = [runner.link.at.line for _, runner in rows]
    return Table(columns)
