"""Presets: robots of the literature, every figure with its source or marked as an estimate."""

from __future__ import annotations

from typing import TYPE_CHECKING

from crawler2d._arrays import real_number
from crawler2d.robot import Drivetrain, Robot, TrackOutline

if TYPE_CHECKING:
    from crawler2d.track import Track

__all__ = ["engineer"]


def engineer(
    *,
    center_of_mass: tuple[float, float] = (0.0, 0.02),
    belly_clearance: float = 0.034,
    flippers: None = None,
    track: Track | None = None,
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
    track : Track, optional
        The model of the track; None is `Robot`'s default.

    Returns
    -------
    Robot
        The preset.

    Raises
    ------
    ScenarioError
        If an argument is no number or no point.

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
    return robot if track is None else robot.with_track(track)
