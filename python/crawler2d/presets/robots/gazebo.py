"""Robots from Gazebo models: Absolem and MARV of the SubT challenge, and the example world's."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Literal

from crawler2d.common.keywords import takes_keywords
from crawler2d.parameters.drivetrain import Drivetrain
from crawler2d.parameters.flippers import Flippers
from crawler2d.parameters.outline import TrackOutline
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.track import BeltTrack, GrouserBeltTrack, LineOfWheels, Track
from crawler2d.presets.robots.choices import is_rough, with_choices

__all__ = ["absolem", "gz_tracked_vehicle", "marv"]


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
    here their mass is spread evenly from pivot to tip. Its flippers pivot 0.95 mm above the axles,
    here on them. The friction of its tracks is 0.7 along their length
    (tracked_vehicle_simple.sdf:121); here friction belongs to the terrain.

    Examples
    --------
    >>> gz_tracked_vehicle().mass
    28.26
    """
    # Body and one track, from the file: mass, position relative to the middle of the axles, pitch
    # inertia.
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


@takes_keywords
def absolem(
    *,
    flippers: Flippers | Literal["built"] | None = "built",
    track: Track | Literal["public"] | None = None,
    source: Literal["subt", "rough"] = "subt",
) -> Robot:
    """Make the BlueBotics Absolem, a 39 kg tracked robot with four flippers.

    Parameters
    ----------
    flippers : Flippers, "built" or None
        "built" takes the robot's own; None leaves them and their mass off.
    track : Track or "public", optional
        The model of the track; None takes `Robot`'s default. "public" has the wheels of the public
        simulation model: eight overlapping wheels per track, five per flipper. Its authors report
        that ground gets stuck between two of them and stops the robot where tracks would continue.
    source : {"subt", "rough"}
        Source of mass and torques: the simulation model of the SubT challenge, or the description
        of the ROUGH data set, with 40 kg and rated torques.

    Returns
    -------
    Robot
        The preset.

    Raises
    ------
    ScenarioError
        If `flippers`, `track` or `source` is another string.

    Notes
    -----
    ==================  ====================================  ====================================
    figure              value                                 source
    ==================  ====================================  ====================================
    axle distance       0.5 m                                 absolem.sdf:1273, 1672
    radius              0.089 m                               absolem.sdf:1291
    gauge               0.397 m                               absolem.sdf:1273
    mass                35.6983 kg without flippers           absolem.sdf: all its links but those
                                                              of the flippers, sensors included
    centre of mass      (-0.03139, 0.10286) m, the same       the same
    moment of inertia   1.5354 kg m^2, the same               the same
    flippers            0.33 m long                           absolem.sdf:988, 1216
                        0.089 to 0.029 m                      absolem.sdf:1006, 1234
                        0.75 kg each                          absolem.sdf:991, five times
                        at most 0.785398 rad/s, 20 N m each   absolem.sdf:968, 967
                        0.8 rad up at the start               estimate: clear of the obstacle; the
                                                              file has them 0.19 rad down
    belly               0.559 m long, 30 to 169 mm above the  absolem.sdf:18, 21, 34, 37: hull and
                        axles                                 its bow
    max. speed          0.4 m/s                               absolem_specifications.md:51
    max. acceleration   1.4 m/s^2                             the same, from odometry
    max. deceleration   4 m/s^2                               estimate: that of `Robot.simple`
    max. torque, track  for the mass with flippers            estimates: those of `Robot.simple`
    mass, grousers
    rotors              0.17 kg m^2 a track                   estimate: rated torque squared over
                                                              power (ROUGH) times 0.04 s, in which a
                                                              motor runs up
                        0.42 kg m^2 a flipper                 estimate: midway from that to torque
                                                              over rate (SubT) times the same
    "rough"             40 kg with flippers                   ROUGH
                        30 N m a sprocket, 30 N m a flipper   ROUGH: rated, of motors of 210 W
                        moment of inertia in proportion,      estimate: what the robot has more is
                        the same centre of mass               spread like the rest
    public wheels       8 of 0.089 m, evenly spaced between   absolem.sdf:1273 to 1690
                        the axles; 5 a flipper, 0.089 to      absolem.sdf:988 to 1234
                        0.029 m, evenly spaced
    ==================  ====================================  ====================================

    absolem.sdf is model.sdf of submitted_models/ctu_cras_norlab_absolem_sensor_config_1 in
    osrf/subt, before its wheels were replaced by tracks (b626b6de^); absolem_specifications.md is
    specifications.md there. ROUGH is the table of platforms in README.md of ctu-vras/rough-dataset
    (084cbea5), which the tests do not read. Rotors do not depend on `source`: they belong to the
    motors that ROUGH describes.

    Its foremost wheel sits 15 mm inboard of the others (absolem.sdf:1287), across the track; in
    side view the line is even. Its flippers pivot 0.95 mm above the axles (absolem.sdf:922), here
    on them. Each of the five links of a flipper has its centre of mass 80 mm beyond its wheel
    (absolem.sdf:990) and the moment of inertia of a whole flipper (absolem.sdf:996); here the mass
    is spread evenly from pivot to tip. The friction of its wheels is 0.5 along their first
    direction, which is the axle, and 1 across it, along the track (absolem.sdf:1018, 1019, 1022):
    on floors with less grip, the floor decides. Here friction belongs to the terrain.

    Examples
    --------
    The jam that its authors report, between wheels of the front flippers on slippery ground:

    >>> import crawler2d as c2d
    >>> step = c2d.terrains.step(0.10, friction=0.5)
    >>> drive = c2d.Drive(gait=c2d.Climb())
    >>> run = c2d.simulate(absolem(track="public"), step, drive=drive)
    >>> str(run.outcome), str(run.mechanism)
    ('seized', 'straddled')
    >>> str(c2d.simulate(absolem(), step, drive=drive).outcome)
    'cleared'

    At this friction the wheels seize like this on steps, knife edges of 10 mm and barriers of 100
    mm, all 80 to 120 mm high, in all of 150 runs; those of 70, 130 and 140 mm all 90 runs clear.
    Without rotors they seize from 70 to 130 mm, in all of 210 runs. With the belt all 240 runs of
    70 to 140 mm clear; it never gets into such a pose, and does not escape when placed in one (0 of
    15). Without flippers, the wheels seized in none of 550 runs on steps of 60 to 120 mm, friction
    0.6 to 1.0.
    """
    rough = is_rough(source)
    built = Flippers(
        length=0.33,
        root_radius=0.089,
        tip_radius=0.029,
        mass=0.75,
        ends="both",
        angle=0.8,
        rate_limit=0.785398,
        torque_limit=30.0 if rough else 20.0,
        rotor_inertia=0.42,
    )
    links = 35.6983
    chassis = 40.0 - 4.0 * built.mass if rough else links
    whole = chassis + 4.0 * built.mass
    robot = Robot.simple(whole, axle_distance=0.5, radius=0.089, name="absolem", max_speed=0.4)
    rear, front, bottom, top = -0.372085, 0.187487, 0.02995, 0.16895
    robot = replace(
        robot,
        mass=chassis,
        center_of_mass=(-0.03139, 0.10286),
        moment_of_inertia=1.5354 * (chassis / links),
        belly=((rear, bottom), (front, bottom), (front, top), (rear, top)),
        gauge=0.397,
        drivetrain=replace(robot.drivetrain, max_acceleration=1.4, rotor_inertia=0.17),
    )
    if rough:
        robot = replace(robot, drivetrain=replace(robot.drivetrain, max_torque=30.0))
    public = (LineOfWheels(8), LineOfWheels(5))
    return with_choices(robot, flippers=flippers, built=built, track=track, public=public)


@takes_keywords
def marv(
    *,
    flippers: Flippers | Literal["built"] | None = "built",
    track: Track | Literal["public"] | None = None,
    source: Literal["subt", "rough"] = "subt",
) -> Robot:
    """Make MARV of the SubT challenge, a 60 kg robot that has no tracks but four large flippers.

    Parameters
    ----------
    flippers : Flippers, "built" or None
        "built" takes the robot's own. None leaves them and their mass off: the robot then stands on
        their roots.
    track : Track or "public", optional
        The model between the flippers' pivots. None takes two wheels, the roots of the flippers,
        and belts with grousers round the arms. "public" takes the wheels of the public simulation
        model, eight per flipper.
    source : {"subt", "rough"}
        Source of mass and torques: the simulation model of the SubT challenge, based on drawings,
        or the description of the ROUGH data set, with 70 kg and rated torques.

    Returns
    -------
    Robot
        The preset.

    Raises
    ------
    ScenarioError
        If `flippers`, `track` or `source` is another string.

    Notes
    -----
    ==================  ====================================  ====================================
    figure              value                                 source
    ==================  ====================================  ====================================
    pivots              0.512 m apart                         marv.sdf:469, twice
    gauge               0.496 m                               marv.sdf:469, twice
    mass                45.726 kg without flippers            marv.sdf: all its links but those of
                                                              the flippers, sensors included
    centre of mass      (0.00292, 0.06481) m, the same        the same
    moment of inertia   1.7532 kg m^2, the same               the same
    flippers            0.3035 m between their axles          marv.sdf:618, 1045
                        0.1165 to 0.078 m                     marv.sdf:636, 1063
                        3.659 kg each                         marv.sdf:621, eight times
                        at most 1 rad/s, 120 N m each         marv.sdf:522, 521
                        0.5 rad up at the start               estimate: clear of the obstacle; the
                                                              file has them level
                        grousers of `Robot.simple`            estimate
    belly               0.6 x 0.236 m, 73 mm above ground,    marv.sdf:18, 21, 26, 29, 34, 38
                        bow and stern rounded below
    max. speed          1 m/s                                 marv.sdf:669, at the root's radius
    max. acceleration   3 m/s^2                               config/common.yaml of its package
    max. deceleration   4 m/s^2                               estimate: that of `Robot.simple`
    max. torque, track  for the mass with flippers            estimates: those of `Robot.simple`
    mass, grousers
    rotors              0.25 kg m^2 a side, 6.5 a flipper     estimates: rated torque squared over
                                                              power (ROUGH) times 0.04 s, in which a
                                                              motor runs up; two motors a side
    "rough"             70 kg with flippers                   ROUGH
                        50 N m a side, 180 N m a flipper      ROUGH: rated, of motors of 200 W;
                                                              25 N m for each of the four tracks
                        moment of inertia in proportion,      estimate: what the robot has more is
                        the same centre of mass               spread like the rest
    public wheels       8 a flipper, 0.1165 to 0.078 m,       marv.sdf:618 to 1063
                        evenly spaced
    ==================  ====================================  ====================================

    marv.sdf is model.sdf of submitted_models/ctu_cras_norlab_marv_sensor_config_1 in osrf/subt,
    before its wheels were replaced by tracks (b626b6de^); the tests do not read common.yaml, where
    the line is rover_maxTrackAcceleration. Its quarter circles of 44 mm become four chords here, at
    most 1 mm inside. ROUGH is the table of platforms in README.md of ctu-vras/rough-dataset
    (084cbea5), which the tests do not read either. Rotors do not depend on `source`: they belong to
    the motors that ROUGH describes.

    There is no track between the roots, so no ground can be inside one there. The package gives the
    robot's mass as 61 kg; the sum over all links is 60.36 kg.

    Examples
    --------
    >>> round(marv().mass, 2)
    60.36
    """
    rough = is_rough(source)
    built = Flippers(
        length=0.3035,
        root_radius=0.1165,
        tip_radius=0.078,
        mass=3.659,
        ends="both",
        angle=0.5,
        rate_limit=1.0,
        torque_limit=180.0 if rough else 120.0,
        rotor_inertia=6.5,
        track=GrouserBeltTrack(),
    )
    roots = LineOfWheels(2, as_track=False)
    links = 45.726
    chassis = 70.0 - 4.0 * built.mass if rough else links
    whole = chassis + 4.0 * built.mass
    robot = Robot.simple(whole, axle_distance=0.512, radius=0.1165, name="marv", max_speed=1.0)
    bow = [_bow(step * math.pi / 8.0) for step in range(5)]
    robot = replace(
        robot,
        mass=chassis,
        center_of_mass=(0.00292, 0.06481),
        moment_of_inertia=1.7532 * (chassis / links),
        belly=(*bow, (0.3, 0.1921), (-0.3, 0.1921), *((-x, y) for x, y in reversed(bow))),
        gauge=0.496,
        drivetrain=replace(robot.drivetrain, max_acceleration=3.0, rotor_inertia=0.25),
        track=roots,
    )
    if rough:
        robot = replace(robot, drivetrain=replace(robot.drivetrain, max_torque=50.0))
    public = (roots, LineOfWheels(8))
    return with_choices(robot, flippers=flippers, built=built, track=track, public=public)


def _bow(angle: float) -> tuple[float, float]:
    """Return a point of the lower bow, from below its axle (0) to its level (pi / 2)."""
    radius = 0.044
    return 0.256 + radius * math.sin(angle), 0.0001 - radius * math.cos(angle)
