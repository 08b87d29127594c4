"""MARV, as its team modelled it for the SubT challenge."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Literal

from crawler2d.common.keywords import takes_keywords
from crawler2d.parameters.flippers import Flippers
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.track import GrouserBeltTrack, LineOfWheels, Track
from crawler2d.presets.robots.finish import finished, is_rough

__all__ = ["marv"]


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
        What runs between the flippers' pivots. None takes two wheels, the roots of the flippers,
        and belts with grousers round the arms. "public" has the wheels of the public simulation
        model, eight per flipper.
    source : {"subt", "rough"}
        Where mass and torques are from, which were published twice: the simulation model of the
        SubT challenge, from drawings, or the description of the ROUGH data set, which has 70 kg and
        rated torques.

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
    (084cbea5), which the tests do not read either. Rotors are the same with both sources: they are
    of the motors that ROUGH describes.

    There is no track between the roots, so no ground is inside one there. The package gives the
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
    return finished(robot, flippers=flippers, built=built, track=track, public=public)


def _bow(angle: float) -> tuple[float, float]:
    """Return a point of the lower bow, from below its axle (0) to its level (pi / 2)."""
    radius = 0.044
    return 0.256 + radius * math.sin(angle), 0.0001 - radius * math.cos(angle)
