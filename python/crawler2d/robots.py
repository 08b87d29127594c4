"""Presets: robots of the literature, every figure with its source or marked as an estimate."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

from crawler2d._arrays import real_number
from crawler2d.errors import ScenarioError
from crawler2d.robot import Drivetrain, Robot, TrackOutline
from crawler2d.track import BeltTrack, HybridWheels, LineOfWheels, Track

__all__ = ["absolem", "engineer", "gz_tracked_vehicle"]


def engineer(
    *,
    center_of_mass: tuple[float, float] = (0.0, 0.02),
    belly_clearance: float = 0.034,
    flippers: None = None,
    track: Track | Literal["public"] | None = None,
) -> Robot:
    """Make the Servosila Engineer, a 21 kg tracked robot, without its flippers.

    Parameters
    ----------
    center_of_mass : array_like, shape (2,)
        [m] In the chassis frame. Estimate; it moves the highest step that the robot climbs most.
    belly_clearance : float
        [m] From level ground to the belly. Estimate; it decides when the robot lies on an edge.
    flippers : None
        Only None for now.
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
    mass                21.2 kg with the arm                 public URDF
    moment of inertia   uniform rectangle 0.482 x 0.130 m    estimate; the size is the mesh's
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
    mass = 21.2
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
        flippers=flippers,
        gauge=0.2,
        drivetrain=Drivetrain(
            max_speed=1.39,
            max_acceleration=0.2,
            max_deceleration=4.0,
            max_torque=6.0,
        ),
    )
    public = HybridWheels(((-0.186, 0.0, 0.08), (0.0, 0.0, 0.08), (0.186, 0.0, 0.08)))
    return _with_track(robot, track, public)


def absolem(*, flippers: None = None, track: Track | Literal["public"] | None = None) -> Robot:
    """Make the BlueBotics Absolem, a 38 kg tracked robot, without its flippers.

    Parameters
    ----------
    flippers : None
        Only None for now.
    track : Track or "public", optional
        The model of the track; None is `Robot`'s default, "public" that of the public simulation
        model: eight wheels a track that overlap. Its makers tell of ground that gets stuck between
        two of them and stops the robot where tracks would go on.

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
    max. speed          0.4 m/s                              the same
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
    >>> run = c2d.simulate(absolem(track="public"), c2d.terrains.step(0.11))
    >>> str(run.outcome), str(run.mechanism)
    ('seized', 'straddled')
    >>> str(run.branch(track=c2d.BeltTrack()).outcome)
    'cleared'
    """
    robot = replace(
        Robot.simple(38.0, axle_distance=0.5, radius=0.089, name="absolem", max_speed=0.4),
        center_of_mass=(0.0, 0.05),
        belly=((-0.25, 0.03), (0.25, 0.03), (0.25, 0.169), (-0.25, 0.169)),
        flippers=flippers,
        gauge=0.397,
    )
    drivetrain = replace(robot.drivetrain, max_acceleration=1.4)
    return _with_track(replace(robot, drivetrain=drivetrain), track, LineOfWheels(8))


def gz_tracked_vehicle(
    *, flippers: None = None, track: Track | Literal["public"] | None = None
) -> Robot:
    """Make the tracked vehicle of Gazebo's example world, without its flippers.

    Parameters
    ----------
    flippers : None
        Only None for now.
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
    mass                25.26 kg: body 13.14, tracks 6.06    the same
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
    25.26
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
        flippers=flippers,
        gauge=0.397,
        drivetrain=Drivetrain(
            max_speed=1.0, max_acceleration=1.0, max_deceleration=4.0, max_torque=200.0
        ),
    )
    return _with_track(robot, track, BeltTrack())


def _with_track(robot: Robot, track: Track | str | None, public: Track) -> Robot:
    if track is None:
        return robot
    if isinstance(track, str):
        if track != "public":
            raise ScenarioError("track", track, 'must be a track model, "public" or None')
        return robot.with_track(public)
    return robot.with_track(track)
