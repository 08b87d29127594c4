"""The Servosila Engineer."""

from __future__ import annotations

from typing import Literal

from crawler2d.common.arrays import real_number
from crawler2d.common.keywords import takes_keywords
from crawler2d.parameters.drivetrain import Drivetrain
from crawler2d.parameters.flippers import Flippers
from crawler2d.parameters.outline import TrackOutline
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.track import HybridWheels, LineOfWheels, Track
from crawler2d.presets.robots.choices import with_choices

__all__ = ["engineer"]


@takes_keywords
def engineer(
    *,
    center_of_mass: tuple[float, float] = (0.0, 0.02),
    belly_clearance: float = 0.034,
    flippers: Flippers | Literal["built"] | None = "built",
    track: Track | Literal["public"] | None = None,
) -> Robot:
    """Make the Servosila Engineer, a 21 kg tracked robot with two flippers at the front.

    Parameters
    ----------
    center_of_mass : array_like, shape (2,)
        [m] Centre of mass without the flippers, in the chassis frame. An estimate, and the one with
        the largest effect on the highest step that the robot can climb.
    belly_clearance : float
        [m] Distance from level ground to the belly. An estimate, which decides when the belly
        touches an edge.
    flippers : Flippers, "built" or None
        "built" takes the robot's own. None removes them but adds their mass to the chassis;
        `Robot.without_flippers` also removes the mass.
    track : Track or "public", optional
        The model of the track; None takes `Robot`'s default. "public" takes the wheels, but nothing
        else, of the public simulation model: three per side with gaps of 26 mm between them, and
        one at the tip of each flipper.

    Returns
    -------
    Robot
        The preset.

    Raises
    ------
    ScenarioError
        If an argument is not a number or a point, or `track` is another string.

    Notes
    -----
    ==================  ====================================  ====================================
    figure              value                                 source
    ==================  ====================================  ====================================
    axle distance       0.365 m                               CAD mesh; eng.xacro:144 and 149 have
                                                              wheels 0.372 m apart
    radius to the tips  0.064 m, belt 0.052 m                 CAD mesh
    grousers            pitch 48, thickness 6, height 12 mm   CAD mesh
    mass                21.2 kg with manipulator, flippers    eng.xacro: its links, 12.35 kg, and
                                                              those of the manipulator that are
                                                              commented out, 8.85 kg
    moment of inertia   uniform rectangle 0.482 x 0.130 m     estimate; the size is the CAD mesh's.
                        and the flippers                      The file has placeholders
    flippers            0.34 m long                           CAD mesh; eng.xacro:160 (its wheel)
                        0.064 to 0.037 m                      CAD mesh
                        0.775 kg each                         eng.xacro:133; the wheel of 0.1 kg at
                                                              its tip counts to the chassis
                        0.8 rad up at the start               estimate: clear of the obstacle
                        at most 1 rad/s                       estimate: as MARV's
                        30 N m each                           estimate: 1.6 times what lifts half
                                                              of the robot with both tips
    track mass          2.4 kg, both tracks                   estimate: 11 % of the robot
    centre of mass      (0, 0.02) m                           estimate: midway between the axles,
                                                              a little above them
    belly               0.365 m long, 34 mm above level       estimate: as long as the axles are
                        ground, to 50 mm above the axles      apart, half the radius above ground
    gauge               0.2 m                                 estimate: within the chassis, 0.265 m
                                                              wide in the CAD mesh
    max. speed          1.39 m/s                              declared by the maker (paper, Table 1)
    max. acceleration   0.2 m/s^2                             the robot's (paper, Table 3)
    max. deceleration   4 m/s^2                               2 cm of braking from 0.4 m/s (paper,
                                                              Table 3)
    max. torque         6 N m a sprocket                      estimate: 1.6 times what holds the 45
                                                              degrees of the robot (paper, Table 1)
    rotors              0.017 kg m^2 a track                  estimate: torque over speed times 0.04
                                                              s, in which a motor runs up; speed
                                                              midway from 0.4 to 1.39 m/s
                        1.2 kg m^2 a flipper                  estimate: the same of its torque and
                                                              rate
    public wheels       radius 0.08 m, 0.186 m ahead of the   eng.xacro:15, 144, 149, 154
                        middle, on it and behind it
                        0.056 m at the flipper's tip          eng.xacro:16, 160
    ==================  ====================================  ====================================

    The paper is "Gear Wheels based Simulation of Crawlers for Mobile Robot Servosila Engineer".
    eng.xacro and the CAD meshes are from the package eng_description in GimpelZhang's
    Robot_Engineer. Figures of the meshes were measured; the tests do not read them.

    Only the wheels are taken from that model, which has motors of 100 N m per wheel
    (eng.xacro:115), tracks 0.55 m apart (eng.xacro:144) and no manipulator. Its flippers have no
    wheel at the root; the one here lies inside the robot's front wheel and touches nothing.

    Examples
    --------
    >>> robot = engineer()
    >>> robot.mass, robot.outline.axle_distance
    (21.2, 0.365)
    """
    built = Flippers(
        length=0.34,
        root_radius=0.064,
        tip_radius=0.037,
        mass=0.775,
        angle=0.8,
        rate_limit=1.0,
        torque_limit=30.0,
        rotor_inertia=1.2,
    )
    mass = 21.2 - (0.0 if flippers is None else 2.0 * built.mass)
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
            rotor_inertia=0.017,
        ),
    )
    wheels = HybridWheels(((-0.186, 0.0, 0.08), (0.0, 0.0, 0.08), (0.186, 0.0, 0.08)))
    public = (wheels, LineOfWheels(2, wheel_radius=0.056))
    return with_choices(robot, flippers=flippers, built=built, track=track, public=public)
