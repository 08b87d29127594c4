"""The tracked vehicle of Gazebo's example world."""

from __future__ import annotations

from typing import Literal

from crawler2d.common.keywords import takes_keywords
from crawler2d.parameters.drivetrain import Drivetrain
from crawler2d.parameters.flippers import Flippers
from crawler2d.parameters.robot import Robot, TrackOutline
from crawler2d.parameters.track import BeltTrack, Track
from crawler2d.presets.robots.choices import with_choices

__all__ = ["gz_tracked_vehicle"]


@takes_keywords
def gz_tracked_vehicle(
    *,
    flippers: Flippers | Literal["built"] | None = "built",
    track: Track | Literal["public"] | None = None,
) -> Robot:
    """Make the tracked vehicle of Gazebo's example world, with its four flippers.

    Parameters
    ----------
    flippers : Flippers, "built" or None
        "built" takes the robot's own; None leaves them and their mass off.
    track : Track or "public", optional
        The model of the track; None and "public" take a smooth belt, which is what Gazebo's track
        controller models.

    Returns
    -------
    Robot
        The preset.

    Raises
    ------
    ScenarioError
        If `flippers` or `track` is another string.

    Notes
    -----
    ==================  ====================================  ====================================
    figure              value                                 source
    ==================  ====================================  ====================================
    axle distance       0.5 m                                 tracked_vehicle_simple.sdf:129, 147
    radius              0.09047 m                             tracked_vehicle_simple.sdf:133
    grousers            none                                  the same: its tracks are smooth
    gauge               0.397 m                               tracked_vehicle_simple.sdf:98
    mass                25.26 kg without flippers: body       tracked_vehicle_simple.sdf:67, 101
                        13.14, tracks 6.06 each               tracked_vehicle_simple.sdf:201
    centre of mass      (-0.0635, 0.0496) m, the same         the same links
    moment of inertia   0.529 kg m^2, the same                the same links
    flippers            0.33 m long                           tracked_vehicle_simple.sdf:334
                        0.089 to 0.029 m                      tracked_vehicle_simple.sdf:316, 338
                        0.75 kg each                          tracked_vehicle_simple.sdf:301
                        0.5 rad up at the start               tracked_vehicle_simple.sdf:298
                        at most 1 rad/s and 50 N m            estimates: there they are locked
                                                              (tracked_vehicle_simple.sdf:471)
    belly               0.50017 m long, 30 to 169 mm above    tracked_vehicle_simple.sdf:78, 81
                        the axles
    max. speed          1 m/s                                 tracked_vehicle_simple.sdf:1085
    track mass          0.1 kg                                estimate: the controller has none
    max. acceleration   1 m/s^2, deceleration 4 m/s^2         estimates: those of `Robot.simple`
    max. torque         200 N m                               estimate: the controller has no limit
    ==================  ====================================  ====================================

    tracked_vehicle_simple.sdf is from gazebosim/gz-sim, examples/worlds, 93bbf3ed.

    The centre of mass of its flippers lies 80 mm from the pivot (tracked_vehicle_simple.sdf:300);
    here their mass is spread evenly from pivot to tip. They pivot 0.95 mm above the axles, here on
    them. The friction of its tracks is 0.7 along their length (tracked_vehicle_simple.sdf:121);
    here friction belongs to the terrain.

    Examples
    --------
    >>> gz_tracked_vehicle().mass
    28.26
    """
    # Body and one track, from the file: mass, place relative to the axles' middle, pitch inertia.
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
    built = Flippers(
        length=0.33,
        root_radius=0.089,
        tip_radius=0.029,
        mass=0.75,
        ends="both",
        angle=0.5,
        rate_limit=1.0,
        torque_limit=50.0,
    )
    public = (BeltTrack(), None)
    return with_choices(robot, flippers=flippers, built=built, track=track, public=public)
