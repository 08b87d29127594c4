"""The chain in crawler2d: `SegmentalTrack` on its guide, the same robot and ground.

The outer faces of the shoes run along the same outline. The drive pulls along the shoes of the rear
end, with the force of the same torque; hull, sprockets and shoes have the same weights.
"""

from __future__ import annotations

from benches.peers import chain_robot
from benches.peers.chain_robot import ChainRobot
from benches.peers.engine import Setting
from benches.peers.motion import Array
from crawler2d.parameters.drivetrain import Drivetrain
from crawler2d.parameters.robot import Robot, TrackOutline
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Drive, SeizureCriteria, Solver, Start
from crawler2d.parameters.terrain import Points
from crawler2d.parameters.track import SegmentalTrack

# [s] Longer than any run, so that nothing ends it.
_NEVER = 1000.0
# [m/s^2] The motor in pymunk has no ramp.
_AT_ONCE = 100.0


def scenario(
    robot: ChainRobot, profile: Array, setting: Setting, duration: float, shift: float
) -> Scenario:
    """Make the scenario of the robot on a ground, starting `shift` [m] further back.

    Parameters
    ----------
    robot : ChainRobot
        The robot.
    profile : ndarray, shape (n, 2)
        [m] The ground from left to right; the robot stands in front of its second point.
    setting : Setting
        Its accuracy counts.
    duration, shift : float
        [s], [m]
    """
    return Scenario(
        _robot(robot),
        Points(
            tuple(map(tuple, profile.tolist())),
            goal=float(profile[-1, 0]) - 1.0,
            friction=chain_robot.FRICTION,
        ),
        drive=Drive(speed=chain_robot.SPEED),
        start=Start(
            approach=float(profile[1, 0]) - robot.axle_distance / 2.0 - robot.radius + shift
        ),
        duration=duration,
        solver=Solver(accuracy=setting.accuracy),
        criteria=SeizureCriteria(stop_window=_NEVER),
    )


def _robot(robot: ChainRobot) -> Robot:
    return Robot(
        f"chain of {robot.shoe_count}",
        mass=robot.mass,
        center_of_mass=(0.0, 0.0),
        moment_of_inertia=robot.moment_of_inertia,
        track_mass=robot.chain_mass,
        outline=TrackOutline(
            axle_distance=robot.axle_distance,
            front_radius=robot.radius,
            rear_radius=robot.radius,
            grouser_height=0.0,
            grouser_pitch=robot.pitch,
            grouser_thickness=0.1 * robot.pitch,
        ),
        belly=tuple(map(tuple, robot.hull().tolist())),
        gauge=0.3,
        drivetrain=Drivetrain(
            max_speed=1.0,
            max_acceleration=_AT_ONCE,
            max_deceleration=_AT_ONCE,
            # Torque of one of two sprockets.
            max_torque=chain_robot.TORQUE / 2.0,
        ),
        track=SegmentalTrack(shoe_count=robot.shoe_count, plate_thickness=robot.plate_thickness),
    )
