"""A tracked robot and the model of its track."""

from __future__ import annotations

import math
import os
from dataclasses import KW_ONLY, dataclass, replace
from typing import TYPE_CHECKING, Literal

from crawler2d import _core
from crawler2d.common.arrays import Table, real_number
from crawler2d.common.bodies import Belly
from crawler2d.common.keywords import takes_keywords
from crawler2d.errors import ScenarioError
from crawler2d.parameters.drivetrain import Drivetrain
from crawler2d.parameters.fields import Parameters
from crawler2d.parameters.flippers import Flippers
from crawler2d.parameters.outline import TrackOutline
from crawler2d.parameters.settings import Drive, ScenarioBase, Solver
from crawler2d.parameters.terrain import Points, Terrain
from crawler2d.parameters.track import BeltTrack, ClosedTrack, Track, WheeledTrack

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Robot"]

# Proportions of the Servosila Engineer's grousers, whose radius is 64 mm.
_GROUSER_HEIGHT = 0.012 / 0.064
_GROUSER_PITCH = 0.048 / 0.064
_GROUSER_THICKNESS = 0.006 / 0.048

# Enough torque to hold the robot on this slope, with this margin: geometry limits climbing.
_HOLDING_SLOPE = math.radians(45.0)
_HOLDING_MARGIN = 1.6

_LEVEL = Points(((-1e3, 0.0), (1e3, 0.0)), goal=0.0)


@dataclass(frozen=True, slots=True)
class Robot(Parameters, path="robot"):
    """A tracked robot: `track` is the model of its track, the other fields are its design.

    Total mass, centre of mass and moment of inertia are the same for every track model.

    Parameters
    ----------
    name : str
        Name shown in tables and plots, of at most 1000 characters.
    mass : float
        [kg] Mass of the whole robot, including both tracks and all flippers.
    center_of_mass : array_like, shape (2,)
        [m] Centre of mass in the chassis frame, which is that of the outline: x forward, y up.
    moment_of_inertia : float
        [kg m^2] Moment of inertia of the whole robot about its centre of mass, with the flippers at
        angle 0. Larger than that of all moving parts, and than `track_mass` times the square of the
        largest radius.
    track_mass : float
        [kg] Mass of both tracks together, all moving at track speed: at least a hundred-thousandth
        of `mass`, which must leave as much for the chassis.
    outline : TrackOutline
        Side view of the track.
    gauge : float
        [m] Lateral distance between the tracks.
    drivetrain : Drivetrain
        The motors and gears that drive the tracks, and their limits.
    belly : array_like, shape (n, 2), optional
        [m] Underside of the chassis: a convex polygon of 3 to 64 corners in the chassis frame,
        counter-clockwise; None: it never touches the ground.
    flippers : Flippers, optional
        Pivoting arms, or None. Setting this field does not change any mass; `with_flippers` and
        `without_flippers` do.
    track : Track
        The model of the track.
    """

    name: str
    _: KW_ONLY
    mass: float
    center_of_mass: tuple[float, float]
    moment_of_inertia: float
    track_mass: float
    outline: TrackOutline
    belly: Belly | None = None
    flippers: Flippers | None = None
    gauge: float
    drivetrain: Drivetrain
    track: Track = BeltTrack()

    @takes_keywords
    def with_track(self, track: Track) -> Robot:
        """Return the same robot with another track model.

        Parameters
        ----------
        track : Track
            The model.

        Returns
        -------
        Robot
            A copy. Nothing else changes, except that a model without driven wheels, such as a
            `BeltTrack`, has one drive per side and sets ``torque_sharing="track"``.

        Examples
        --------
        >>> from dataclasses import replace
        >>> import crawler2d as c2d
        >>> robot = c2d.robots.engineer(track=c2d.LineOfWheels(4), flippers=None)
        >>> servos = replace(robot.drivetrain, torque_sharing="wheel")
        >>> robot = replace(robot, drivetrain=servos)
        >>> robot.with_track(c2d.BeltTrack()).drivetrain.torque_sharing
        'track'
        """
        bodies = track.of if isinstance(track, ClosedTrack) else track
        if not isinstance(bodies, WheeledTrack) and self.drivetrain.torque_sharing == "wheel":
            drive = replace(self.drivetrain, torque_sharing="track")
            return replace(self, track=track, drivetrain=drive)
        return replace(self, track=track)

    @takes_keywords
    def with_flippers(self, flippers: Flippers) -> Robot:
        """Mount flippers, and add them to mass, centre of mass and moment of inertia.

        Parameters
        ----------
        flippers : Flippers
            The arms; they replace any that the robot has.

        Returns
        -------
        Robot
            A copy with the arms, added as uniform rods from pivot to tip at angle 0.

        Raises
        ------
        ScenarioError
            If mass or length of the arms is not a number, or `ends` is not one of its three values.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> bare = c2d.robots.engineer(flippers=None)
        >>> arms = c2d.Flippers(
        ...     length=0.34, root_radius=0.064, tip_radius=0.037, mass=0.775, torque_limit=30.0
        ... )
        >>> bare.mass, bare.with_flippers(arms).mass
        (21.2, 22.75)
        """
        return replace(_add_arms(self.without_flippers(), flippers, 1.0), flippers=flippers)

    def without_flippers(self) -> Robot:
        """Remove the arms and their mass.

        Setting `flippers` to None, in contrast, keeps mass, centre of mass and moment of inertia:
        the mass of the arms then belongs to the chassis.

        Returns
        -------
        Robot
            A copy without arms and without the mass that `with_flippers` adds for them.

        Raises
        ------
        ScenarioError
            If no mass is left for the chassis.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> robot = c2d.robots.absolem()
        >>> round(robot.mass, 2), round(robot.without_flippers().mass, 2)
        (38.7, 35.7)
        """
        if self.flippers is None:
            return self
        return replace(_add_arms(self, self.flippers, -1.0), flippers=None)

    def without_rotors(self) -> Robot:
        """Remove the rotor inertia of all motors, as in a simulator that does not model it.

        The engine rapier takes only such robots, and most published simulations have no rotors.
        With rotor inertia a robot gets over more edges.

        Returns
        -------
        Robot
            A copy with a `rotor_inertia` of 0 in drivetrain and flippers.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> robot = c2d.robots.engineer()
        >>> robot.drivetrain.rotor_inertia, robot.without_rotors().drivetrain.rotor_inertia
        (0.017, 0.0)
        """
        arms = self.flippers
        return replace(
            self,
            drivetrain=replace(self.drivetrain, rotor_inertia=0.0),
            flippers=None if arms is None else replace(arms, rotor_inertia=0.0),
        )

    def wheels(self) -> Table:
        """List every wheel of the track model, on both sides and on the flippers.

        Returns
        -------
        Table
            One row per wheel: the left side first, and on each side the wheels of the chassis
            first, in the order of eq. (1) of the paper. Empty for belts, skids and chains of shoes.
            Columns: `side` ("left", "right"), `carrier` ("chassis", "front flipper", "rear
            flipper"), `body` (number as in the contacts if both tracks meet the same ground; the
            same on both sides), `x` and `y` [m] (axle in the chassis frame, with the flippers at
            their `angle`), `radius` [m] (of the circumscribed circle), `area` [m^2] (of the true
            outline), `moment_of_inertia` [kg m^2] (this wheel's share of the moving mass: the
            wheels of the chassis share `track_mass`, those of a flipper a tenth of its mass) and
            `mass` [kg] (of a uniform wheel with this outline and moment of inertia).

        Raises
        ------
        ScenarioError
            If the robot breaks a rule.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> wheels = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(3)).wheels()
        >>> wheels["side"].tolist()
        ['left', 'left', 'left', 'right', 'right', 'right']
        >>> wheels["x"][:3].tolist(), wheels["mass"][:3].tolist()
        ([-0.1825, 0.0, 0.1825], [0.8, 0.8, 0.8])
        """
        return Table(_core.wheels(self._at_rest()))

    @takes_keywords
    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the side view in the chassis frame, with the flippers at their `angle`.

        Shows the bodies of the track model, belly, axles, centre of mass, the main dimensions and,
        where the model deviates from it, the outline of the real track.

        Parameters
        ----------
        ax : Axes, optional
            Where to draw; None makes a figure.

        Returns
        -------
        Axes
            With x and y in metres, at equal scale.

        Raises
        ------
        ScenarioError
            If the robot breaks a rule.
        ImportError
            If matplotlib is missing; the message names the extra to install.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> ax = c2d.robots.engineer(track=c2d.LineOfWheels(4)).plot()
        >>> ax.get_title(loc="left")
        'engineer: 4 round wheels in a line'
        """
        from crawler2d.drawings.views import draw_robot  # noqa: PLC0415 - optional

        return draw_robot(self._at_rest(), self.description, ax)

    @takes_keywords
    def to_sdf(
        self,
        path: str | os.PathLike[str] | None = None,
        *,
        friction: float = 0.9,
        track_width: float | None = None,
        chassis_width: float | None = None,
    ) -> str:
        """Write the robot as an SDF 1.6 model for Gazebo.

        The model is three-dimensional and has both sides: wheels on revolute joints, gear wheels as
        cylinders with boxes, belts as shapes that Gazebo's ``TrackController`` moves, flippers on
        limited joints, the belly. `read_robot` reads back what the file states; a comment holds the
        complete robot. ``docs/conventions.md``, "Writing a model file", says what each format holds
        and which figures are estimates. SDF has no element for rotor inertias, controllers, torque
        curves and the torque of belts: they are left out, and the comment says so.

        Parameters
        ----------
        path : str or PathLike, optional
            File to write; None returns only the text.
        friction : float
            [-] Friction coefficient of all its surfaces; Gazebo uses the smaller one of two
            surfaces.
        track_width : float, optional
            [m] Width of each track. None takes a quarter of the gauge, as on Absolem.
        chassis_width : float, optional
            [m] Width of the belly. None takes the free width between the tracks.

        Returns
        -------
        str
            The text of the file; an interactive console shows only its length.

        Raises
        ------
        ScenarioError
            If the format cannot represent the robot (chains of shoes, travelling grousers, a
            pushing force), or no mass is left for the chassis.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> text = c2d.robots.engineer().to_sdf()  # a belt
        >>> text.count("gz::sim::systems::TrackController")
        4
        """
        return self._export("sdf", path, friction, track_width, chassis_width)

    @takes_keywords
    def to_urdf(
        self,
        path: str | os.PathLike[str] | None = None,
        *,
        friction: float = 0.9,
        track_width: float | None = None,
        chassis_width: float | None = None,
    ) -> str:
        """Write the robot as URDF for ROS and most simulators.

        Like `to_sdf`, with the same parameters, result and errors. URDF has no belts and no motors:
        a wheel's joint has the limits of its motor. The simulator decides how the `friction` of two
        surfaces is combined.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> robot = c2d.robots.engineer(flippers=None)
        >>> robot.with_track(c2d.LineOfWheels(4)).to_urdf().count('type="continuous"')
        8
        >>> robot.to_urdf()
        Traceback (most recent call last):
        ...
        crawler2d.errors.ScenarioError: robot.track.kind must be wheels, got belt: URDF has ...
        """
        return self._export("urdf", path, friction, track_width, chassis_width)

    @takes_keywords
    def to_mjcf(
        self,
        path: str | os.PathLike[str] | None = None,
        *,
        friction: float = 0.9,
        track_width: float | None = None,
        chassis_width: float | None = None,
    ) -> str:
        """Write the robot as MJCF for MuJoCo.

        Like `to_sdf`, with the same parameters, result and errors. Wheels have speed servos and
        flippers rate servos, both with the rotor inertia as ``armature``; the wheels of a track
        divide it and the gain of its controller among them. Without a controller, servos are stiff.
        Torque curves and the torque of belts are left out. Belt surfaces move at the largest speed;
        ``MjModel.geom_surfacevel`` changes it at run time. Gear wheels and belly may have any
        shape. The `friction` applies whatever the ground has. The file has no ground.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4))
        >>> text = robot.to_mjcf(friction=0.7, track_width=0.08)
        >>> text.count("<velocity "), text.count('friction="0.7"')
        (8, 9)
        """
        return self._export("mjcf", path, friction, track_width, chassis_width)

    @takes_keywords
    def to_world(
        self,
        path: str | os.PathLike[str],
        terrain: Terrain,
        *,
        track_width: float | None = None,
        chassis_width: float | None = None,
    ) -> str:
        """Write the robot in front of an obstacle: a world for Gazebo or a scene for MuJoCo.

        The robot stands where a `Scenario` starts it. The ground is the profile of the terrain,
        extruded to twice the width of the robot, separately for each track if the two differ: boxes
        and, on slopes, convex prisms on a plane at the lowest height, or below that if the tracks
        have different friction. The robot is that of `to_sdf` or `to_mjcf`, with the friction of
        the terrain between the two, however the engine combines it. Gravity is 9.81 m/s^2.

        ``gz sim -r world.sdf`` runs the world, and the topic ``/model/NAME/cmd_vel`` drives its
        wheels and belts; ``python -m mujoco.viewer --mjcf=scene.xml`` runs the scene.

        Parameters
        ----------
        path : str or PathLike
            File to write: ``.sdf`` or ``.world`` for SDF 1.6, ``.xml`` for MJCF.
        terrain : terrain
            Any of `crawler2d.terrains`, such as one of `Audit.obstacles`.
        track_width, chassis_width
            See `to_sdf`.

        Returns
        -------
        str
            See `to_sdf`.

        Raises
        ------
        ScenarioError
            If the suffix is unknown, the terrain breaks a rule or has segments of different
            friction, or the format cannot represent the robot.

        Examples
        --------
        >>> import pathlib, tempfile
        >>> import crawler2d as c2d
        >>> robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4))
        >>> path = pathlib.Path(tempfile.mkdtemp()) / "world.sdf"
        >>> _ = robot.to_world(path, c2d.terrains.step(0.075))
        >>> c2d.read_robot(path).robot.mass == robot.mass
        True
        """
        from crawler2d.writing.export import export_world  # noqa: PLC0415 - as above

        if not isinstance(terrain, Terrain):
            raise ScenarioError("terrain", terrain, "must be a terrain")
        widths = {"track_width": track_width, "chassis_width": chassis_width}
        return export_world(self._at_rest(terrain), self._at_rest(), path, **widths)

    @property
    def description(self) -> str:
        """Name and track models, for titles."""
        arms = None if self.flippers is None else self.flippers.track
        of_arms = "" if arms is None else f"; flippers: {arms.description}"
        return f"{self.name}: {self.track.description}{of_arms}"

    def _at_rest(self, terrain: Terrain = _LEVEL) -> str:
        """Write a scenario with nothing else that could break a rule."""
        drive, solver = Drive(speed=0.0), Solver(time_step=1e-5)
        return ScenarioBase(self, terrain, drive=drive, solver=solver).to_json()

    def _export(
        self,
        format_: Literal["sdf", "urdf", "mjcf"],
        path: str | os.PathLike[str] | None,
        friction: float,
        track_width: float | None,
        chassis_width: float | None,
    ) -> str:
        from crawler2d.writing.export import export_robot  # noqa: PLC0415 - costs nothing until used

        return export_robot(
            self._at_rest(),
            format_,
            path,
            friction=friction,
            track_width=track_width,
            chassis_width=chassis_width,
        )

    def _repr_html_(self) -> str | None:
        """Show side view and main figures in a notebook; a broken robot is shown as text."""
        from crawler2d.drawings.svg import robot_card  # noqa: PLC0415 - costs nothing until used

        try:
            return robot_card(self._at_rest(), self.description)
        except Exception:  # the display of a robot must never fail
            return None

    @staticmethod
    @takes_keywords
    def simple(
        mass: float,
        *,
        axle_distance: float,
        radius: float,
        name: str = "simple",
        max_speed: float = 1.0,
        track: Track | None = None,
    ) -> Robot:
        """Make a robot from three numbers; the notes give the rules for all others.

        Parameters
        ----------
        mass : float
            [kg] Mass of the whole robot.
        axle_distance : float
            [m] Distance between the end axles.
        radius : float
            [m] Radius of both ends of the track, measured to the grouser tips.
        name : str
            Name shown in tables and plots.
        max_speed : float
            [m/s] Largest track speed.
        track : Track, optional
            The model of the track; None takes `Robot`'s default.

        Returns
        -------
        Robot
            Use `dataclasses.replace` to change single values.

        Raises
        ------
        ScenarioError
            If `mass`, `axle_distance` or `radius` is not a number above 0.

        Notes
        -----
        - centre of mass: midway between the axles, at axle height;
        - moment of inertia: that of a uniform rectangle round the outline;
        - track mass: a tenth of the mass;
        - grousers: the proportions of the Servosila Engineer; height 3/16 of the radius, pitch
          near 3/4 of the radius such that a whole number fits on the belt, thickness 1/8 of pitch;
        - belly: none; gauge: half the axle distance;
        - acceleration: 1 m/s^2, deceleration 4 m/s^2;
        - torque: 1.6 times what holds the robot on a slope of 45 degrees at 9.81 m/s^2.

        Examples
        --------
        >>> robot = Robot.simple(20.0, axle_distance=0.4, radius=0.06)
        >>> round(robot.moment_of_inertia, 4)
        0.4747
        """
        mass = _read_size(mass, "mass")
        axle_distance = _read_size(axle_distance, "axle_distance")
        radius = _read_size(radius, "radius")
        belt_radius = radius * (1.0 - _GROUSER_HEIGHT)
        perimeter = 2.0 * axle_distance + 2.0 * math.pi * belt_radius
        pitch = perimeter / max(3, round(perimeter / (_GROUSER_PITCH * radius)))
        length, height = axle_distance + 2.0 * radius, 2.0 * radius
        holding_force = mass * 9.81 * math.sin(_HOLDING_SLOPE)
        robot = Robot(
            name,
            mass=mass,
            center_of_mass=(0.0, 0.0),
            moment_of_inertia=mass / 12.0 * (length**2 + height**2),
            track_mass=0.1 * mass,
            outline=TrackOutline(
                axle_distance=axle_distance,
                front_radius=radius,
                rear_radius=radius,
                grouser_height=_GROUSER_HEIGHT * radius,
                grouser_pitch=pitch,
                grouser_thickness=_GROUSER_THICKNESS * pitch,
            ),
            gauge=0.5 * axle_distance,
            drivetrain=Drivetrain(
                max_speed=max_speed,
                max_acceleration=1.0,
                max_deceleration=4.0,
                max_torque=_HOLDING_MARGIN * holding_force * belt_radius / 2.0,
            ),
        )
        return robot if track is None else robot.with_track(track)


def _add_arms(robot: Robot, flippers: Flippers, sign: float) -> Robot:
    """Add (+1) or subtract (-1) the mass of flippers, as uniform rods at angle 0."""
    if not isinstance(flippers, Flippers):
        raise ScenarioError("robot.flippers", flippers, "must be a Flippers")
    length, pair = flippers.length, sign * 2.0 * flippers.mass
    rear_axle, front_axle = robot.outline.ends
    front = (front_axle[0] + 0.5 * length, front_axle[1])
    rear = (rear_axle[0] - 0.5 * length, rear_axle[1])
    centers = {"front": (front,), "rear": (rear,), "both": (front, rear)}
    if flippers.ends not in centers:
        rule = f"must be one of {', '.join(centers)}"
        raise ScenarioError("robot.flippers.ends", flippers.ends, rule)
    arms = centers[flippers.ends]
    mass = robot.mass + pair * len(arms)
    if not mass > 0.0:
        raise ScenarioError("robot.flippers.mass", flippers.mass, "must leave mass for the chassis")
    x, y = robot.center_of_mass
    center = (
        (robot.mass * x + pair * sum(arm[0] for arm in arms)) / mass,
        (robot.mass * y + pair * sum(arm[1] for arm in arms)) / mass,
    )
    inertia = robot.moment_of_inertia
    inertia += robot.mass * ((x - center[0]) ** 2 + (y - center[1]) ** 2)
    for arm in arms:
        inertia += pair * length**2 / 12.0
        inertia += pair * ((arm[0] - center[0]) ** 2 + (arm[1] - center[1]) ** 2)
    return replace(robot, mass=mass, center_of_mass=center, moment_of_inertia=inertia)


def _read_size(value: float, name: str) -> float:
    """Reject sizes with which `Robot.simple` cannot compute; validation is stricter."""
    number = real_number(value, name)
    if not 1e-30 <= number <= 1e30:
        raise ScenarioError(name, value, "must be > 0")
    return number
