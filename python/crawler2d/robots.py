"""Presets: robots of the literature, every figure with its source or marked as an estimate."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Literal

from crawler2d._arrays import real_number
from crawler2d.errors import ScenarioError
from crawler2d.flippers import Flippers
from crawler2d.robot import Drivetrain, Robot, TrackOutline
from crawler2d.track import BeltTrack, GrouserBeltTrack, HybridWheels, LineOfWheels, Track

__all__ = ["absolem", "engineer", "gz_tracked_vehicle", "marv"]


def engineer(
    *,
    center_of_mass: tuple[float, float] = (0.0, 0.02),
    belly_clearance: float = 0.034,
    flippers: Flippers | Literal["built"] | None = "built",
    track: Track | Literal["public"] | None = None,
) -> Robot:
    """Make the Servosila Engineer, a 21 kg tracked robot with two flippers at its front.

    Parameters
    ----------
    center_of_mass : array_like, shape (2,)
        [m] Without the flippers, in the chassis frame. Estimate; it moves the highest step that the
        robot climbs most.
    belly_clearance : float
        [m] From level ground to the belly. Estimate; it decides when the robot lies on an edge.
    flippers : Flippers, "built" or None
        "built" takes its own, None leaves them off: then the chassis has their mass.
    track : Track or "public", optional
        The model of the track; None is `Robot`'s default, "public" that of the public simulation
        model: three wheels a side of radius 0.08 m, slots of 26 mm between them.

    Returns
    -------
    Robot
        The preset.

    Raises
    ------
    ScenarioError
        If an argument is no number or no point, or `track` another word.

    Notes
    -----
    ==================  ===================================  ====================================
    figure              value                                source
    ==================  ===================================  ====================================
    axle distance       0.365 m                              public CAD mesh (URDF: 0.372 m)
    radius to the tips  0.064 m, belt 0.052 m                public CAD mesh
    grousers            pitch 48, thickness 6, height 12 mm  public CAD mesh
    mass                21.2 kg with manipulator, flippers   public URDF
    moment of inertia   uniform rectangle 0.482 x 0.130 m    estimate; the size is the mesh's
                        and the flippers
    flippers            0.34 m long, 0.064 to 0.037 m        public CAD mesh
                        0.775 kg each                        public URDF
                        0.8 rad up, at most 1 rad/s          estimate
                        30 N m each                          estimate: 1.6 times what lifts half
                                                             of the robot with both tips
    track mass          2.4 kg, both tracks                  estimate
    centre of mass      (0, 0.02) m                          estimate
    belly               0.365 m long, 34 mm above level      estimate
                        ground, to 50 mm above the axles
    gauge               0.2 m                                estimate
    max. speed          1.39 m/s (measured: 0.4 m/s)         declared by the maker
    max. acceleration   0.2 m/s^2                            measured on the robot
    max. deceleration   4 m/s^2                              from 2 cm of braking at 0.4 m/s
    max. torque         6 N m a sprocket                     estimate: 1.6 times what holds the
                                                             45 degrees measured on the robot
    ==================  ===================================  ====================================

    The mesh and the URDF are those of the public Robot_Engineer model; the measurements on the
    robot are those of the paper that introduced gear wheels for the simulation of tracks.

    Examples
    --------
    >>> robot = engineer()
    >>> robot.mass, robot.outline.axle_distance
    (21.2, 0.365)
    """
    arms = _flippers(
        flippers,
        Flippers(
            length=0.34,
            root_radius=0.064,
            tip_radius=0.037,
            mass=0.775,
            angle=0.8,
            rate_limit=1.0,
            torque_limit=30.0,
        ),
    )
    mass = 21.2 - (0.0 if arms is None else 2.0 * 0.775)
    length, height = 0.482, 0.130
    axle_distance, radius = 0.365, 0.064
    rear, front = -0.5 * axle_distance, 0.5 * axle_distance
    bottom, top = real_number(belly_clearance, "belly_clearance") - radius, 0.050
    robot = Robot(
        "engineer",
        mass=mass,
        center_of_mass=center_of_mass,
        moment_of_inertia=mass / 12.0 * (length**2 + height**2),
        track_mass=2.4,
        outline=TrackOutline(
            axle_distance=axle_distance,
            front_radius=radius,
            rear_radius=radius,
            grouser_height=0.012,
            grouser_pitch=0.048,
            grouser_thickness=0.006,
        ),
        belly=((rear, bottom), (front, bottom), (front, top), (rear, top)),
        gauge=0.2,
        drivetrain=Drivetrain(
            max_speed=1.39,
            max_acceleration=0.2,
            max_deceleration=4.0,
            max_torque=6.0,
        ),
    )
    public = HybridWheels(((-0.186, 0.0, 0.08), (0.0, 0.0, 0.08), (0.186, 0.0, 0.08)))
    return _finished(robot, arms, track, (public, LineOfWheels(2)))


def absolem(
    *,
    flippers: Flippers | Literal["built"] | None = "built",
    track: Track | Literal["public"] | None = None,
) -> Robot:
    """Make the BlueBotics Absolem, a 38 kg tracked robot with four flippers.

    Parameters
    ----------
    flippers : Flippers, "built" or None
        "built" takes its own, None leaves them off: then the chassis has their mass.
    track : Track or "public", optional
        The model of the track; None is `Robot`'s default, "public" that of the public simulation
        model: eight wheels a track that overlap, five a flipper. Its makers tell of ground that
        gets stuck between two of them and stops the robot where tracks would go on.

    Returns
    -------
    Robot
        The preset.

    Raises
    ------
    ScenarioError
        If `track` is another word.

    Notes
    -----
    ==================  ===================================  ====================================
    figure              value                                source
    ==================  ===================================  ====================================
    axle distance       0.5 m                                public model, SubT challenge
    radius              0.089 m                              the same
    gauge               0.397 m                              that of `gz_tracked_vehicle`
    mass                38 kg with flippers and payload      specification, SubT challenge
    flippers            0.33 m long, 0.089 to 0.029 m, 0.75  `gz_tracked_vehicle`; the same as
                        kg each                              the public model's
                        0.8 rad up, at most pi/4 rad/s       SubT challenge; angle: estimate
                        50 N m each                          estimate: 1.6 times what lifts half
                                                             of the robot with two tips
    max. speed          0.4 m/s                              specification, SubT challenge
    max. acceleration   1.4 m/s^2                            the same, from odometry
    max. deceleration   4 m/s^2                              estimate
    centre of mass      (0, 0.05) m                          estimate
    belly               0.5 m long, 30 mm above the axles    body of `gz_tracked_vehicle`, moved to
                                                             the middle
    all else            as `Robot.simple` has it             estimate
    ==================  ===================================  ====================================

    Examples
    --------
    What its makers tell of:

    >>> import crawler2d as c2d
    >>> run = c2d.simulate(absolem(flippers=None, track="public"), c2d.terrains.step(0.11))
    >>> str(run.outcome), str(run.mechanism)
    ('seized', 'straddled')
    >>> str(run.branch(track=c2d.BeltTrack()).outcome)
    'cleared'
    """
    arms = _flippers(flippers, replace(_GZ_FLIPPERS, rate_limit=math.pi / 4.0, torque_limit=50.0))
    robot = Robot.simple(38.0, axle_distance=0.5, radius=0.089, name="absolem", max_speed=0.4)
    mass = robot.mass - (0.0 if arms is None else 4.0 * _GZ_FLIPPERS.mass)
    robot = replace(
        robot,
        mass=mass,
        moment_of_inertia=robot.moment_of_inertia * mass / robot.mass,
        center_of_mass=(0.0, 0.05),
        belly=((-0.25, 0.03), (0.25, 0.03), (0.25, 0.169), (-0.25, 0.169)),
        gauge=0.397,
        drivetrain=replace(robot.drivetrain, max_acceleration=1.4),
    )
    return _finished(robot, arms, track, (LineOfWheels(8), LineOfWheels(5)))


def gz_tracked_vehicle(
    *,
    flippers: Flippers | Literal["built"] | None = "built",
    track: Track | Literal["public"] | None = None,
) -> Robot:
    """Make the tracked vehicle of Gazebo's example world, with its four flippers.

    Parameters
    ----------
    flippers : Flippers, "built" or None
        "built" takes its own, None leaves them and their mass off.
    track : Track or "public", optional
        The model of the track; None and "public" are a smooth belt, as Gazebo's track controller
        has it.

    Returns
    -------
    Robot
        The preset.

    Raises
    ------
    ScenarioError
        If `track` is another word.

    Notes
    -----
    ==================  ===================================  ====================================
    figure              value                                source
    ==================  ===================================  ====================================
    axle distance       0.5 m                                tracked_vehicle_simple.sdf
    radius              0.09047 m, no grousers               the same
    gauge               0.397 m                              the same
    mass                28.26 kg: body 13.14, tracks 6.06    the same
                        each, flippers 0.75 each
    flippers            0.33 m long, 0.089 to 0.029 m, 0.5   the same; they are locked there
                        rad up
                        at most 1 rad/s and 50 N m           estimate
    centre of mass      (-0.0635, 0.0496) m                  from the masses and places there
    moment of inertia   0.529 kg m^2                         from the inertias and places there
    belly               the body, 0.50 x 0.139 m             the same
    track mass          0.1 kg                               estimate: the controller has none
    max. speed          1 m/s                                estimate
    max. acceleration   1 m/s^2, deceleration 4 m/s^2        estimate
    max. torque         200 N m                              estimate: the controller has no limit
    ==================  ===================================  ====================================

    The friction of its tracks is 0.7 along the way; here friction is the terrain's.

    Examples
    --------
    >>> gz_tracked_vehicle().mass
    28.26
    """
    # Of the body and of a track, in the file: mass, place from the axles' middle, lateral inertia.
    body, track_link = (13.14, (-0.122, 0.09945), 0.302044), (6.06, (0.0, -0.00445), 0.032554)
    links = (body, track_link, track_link)
    mass = sum(link[0] for link in links)
    x, y = (sum(link[0] * link[1][axis] for link in links) / mass for axis in (0, 1))
    inertia = sum(
        own + part * ((place[0] - x) ** 2 + (place[1] - y) ** 2) for part, place, own in links
    )
    robot = Robot(
        "gz_tracked_vehicle",
        mass=mass,
        center_of_mass=(x, y),
        moment_of_inertia=inertia,
        track_mass=0.1,
        outline=TrackOutline(
            axle_distance=0.5,
            front_radius=0.09047,
            rear_radius=0.09047,
            grouser_height=0.0,
            grouser_pitch=0.05,
            grouser_thickness=0.0,
        ),
        belly=(
            (-0.372085, 0.02995),
            (0.128085, 0.02995),
            (0.128085, 0.16895),
            (-0.372085, 0.16895),
        ),
        gauge=0.397,
        drivetrain=Drivetrain(
            max_speed=1.0, max_acceleration=1.0, max_deceleration=4.0, max_torque=200.0
        ),
    )
    arms = _flippers(flippers, replace(_GZ_FLIPPERS, angle=0.5))
    return _finished(robot, arms, track, (BeltTrack(), None))


def marv(
    *,
    flippers: Flippers | Literal["built"] | None = "built",
    track: Track | Literal["public"] | None = None,
) -> Robot:
    """Make MARV of the SubT challenge, a 61 kg robot that has no tracks but four large flippers.

    Parameters
    ----------
    flippers : Flippers, "built" or None
        "built" takes its own. None leaves them off: then the robot stands on their roots.
    track : Track or "public", optional
        What stands between the flippers' pivots. None are the roots of the flippers, two wheels,
        under tracks of the kind of a belt with grousers round the arms; "public" has the wheels of
        the public simulation model on them, five a flipper.

    Returns
    -------
    Robot
        The preset.

    Raises
    ------
    ScenarioError
        If `track` is another word.

    Notes
    -----
    ==================  ===================================  ====================================
    figure              value                                source
    ==================  ===================================  ====================================
    pivots              0.512 m apart                        public model, SubT challenge
    flippers            0.3035 m between their axles,        the same
                        0.1165 to 0.078 m
                        at most 1 rad/s, 120 N m             the same
                        4 kg each, 0.5 rad up                estimate
    body                0.6 x 0.236 m, 73 mm above ground    the same
    mass                61 kg                                the same
    max. speed          1 m/s, 3 m/s^2                       the same
    max. deceleration   4 m/s^2                              estimate
    gauge               0.496 m                              the same
    centre of mass      (0, 0.05) m                          estimate
    all else            as `Robot.simple` has it             estimate
    ==================  ===================================  ====================================

    The line between the roots is no track: ground that reaches above it is called inside the track
    although nothing runs there.

    Examples
    --------
    >>> marv().flippers.ends
    'both'
    """
    arms = _flippers(
        flippers,
        Flippers(
            length=0.3035,
            root_radius=0.1165,
            tip_radius=0.078,
            mass=4.0,
            ends="both",
            angle=0.5,
            rate_limit=1.0,
            torque_limit=120.0,
            track=GrouserBeltTrack(),
        ),
    )
    robot = Robot.simple(61.0, axle_distance=0.512, radius=0.1165, name="marv", max_speed=1.0)
    mass = robot.mass - (0.0 if arms is None else 4.0 * 4.0)
    robot = replace(
        robot,
        mass=mass,
        moment_of_inertia=mass / 12.0 * (0.6**2 + 0.236**2),
        center_of_mass=(0.0, 0.05),
        belly=((-0.3, -0.0439), (0.3, -0.0439), (0.3, 0.1921), (-0.3, 0.1921)),
        gauge=0.496,
        drivetrain=replace(robot.drivetrain, max_acceleration=3.0),
        track=LineOfWheels(2),
    )
    return _finished(robot, arms, track, (LineOfWheels(2), LineOfWheels(5)))


# Of tracked_vehicle_simple.sdf, whose robot has the outline of Absolem.
_GZ_FLIPPERS = Flippers(
    length=0.33,
    root_radius=0.089,
    tip_radius=0.029,
    mass=0.75,
    ends="both",
    angle=0.8,
    rate_limit=1.0,
    torque_limit=50.0,
)


def _flippers(given: Flippers | str | None, built: Flippers) -> Flippers | None:
    if isinstance(given, str):
        if given != "built":
            raise ScenarioError("flippers", given, 'must be Flippers, "built" or None')
        return built
    return given


def _finished(
    robot: Robot,
    flippers: Flippers | None,
    track: Track | str | None,
    public: tuple[Track, Track | None],
) -> Robot:
    """Add the flippers to a robot without them, then model the tracks of both."""
    of_robot, of_flippers = (track, None)
    if isinstance(track, str):
        if track != "public":
            raise ScenarioError("track", track, 'must be a track model, "public" or None')
        of_robot, of_flippers = public
    if of_robot is not None and not isinstance(of_robot, str):
        robot = robot.with_track(of_robot)
    if flippers is None:
        return robot
    if of_flippers is not None:
        flippers = replace(flippers, track=of_flippers)
    return replace(_with_arms(robot, flippers), flippers=flippers)


def _with_arms(robot: Robot, flippers: Flippers) -> Robot:
    """Count the arms, evenly spread and at angle 0, in mass, its centre and moment of inertia."""
    reach = 0.5 * robot.outline.axle_distance + 0.5 * flippers.length
    ends = {"front": (reach,), "rear": (-reach,), "both": (reach, -reach)}[flippers.ends]
    pair = 2.0 * flippers.mass
    mass = robot.mass + pair * len(ends)
    x, y = robot.center_of_mass
    center = ((robot.mass * x + pair * sum(ends)) / mass, robot.mass * y / mass)
    inertia = robot.moment_of_inertia
    inertia += robot.mass * ((x - center[0]) ** 2 + (y - center[1]) ** 2)
    for place in ends:
        inertia += pair * flippers.length**2 / 12.0
        inertia += pair * ((place - center[0]) ** 2 + center[1] ** 2)
    return replace(robot, mass=mass, center_of_mass=center, moment_of_inertia=inertia)
