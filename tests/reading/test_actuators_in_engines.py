"""Actual engines: which values of a joint have an effect if a speed is commanded.

A wheel of 0.01 kg m^2 on a fixed base gets a command of 10 rad/s with 1 N m: after 0.05 s it has
5 rad/s.
"""

import importlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from crawler2d.reading.engines import ENGINES

INERTIA, RATE, TORQUE, STEPS, STEP = 0.01, 10.0, 1.0, 50, 1e-3
USUAL = {"effort": TORQUE, "velocity": 100.0, "damping": 0.0, "friction": 0.0, "armature": 0.0}
OTHER = {"effort": 0.5, "velocity": 3.0, "damping": 0.05, "friction": 0.5, "armature": 0.01}

URDF = """<robot name="r">
<link name="base"><inertial><mass value="100"/>
  <inertia ixx="10" iyy="10" izz="10" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="wheel"><inertial><mass value="1"/>
  <inertia ixx="{0}" iyy="{0}" izz="{0}" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="continuous"><parent link="base"/><child link="wheel"/><axis xyz="0 1 0"/>
  <limit effort="{effort}" velocity="{velocity}"/>
  <dynamics damping="{damping}" friction="{friction}"/></joint></robot>"""

MJCF = """<mujoco><option timestep="{step}" gravity="0 0 0" integrator="implicitfast"/><worldbody>
<body><joint name="j" axis="0 1 0" damping="{damping}" frictionloss="{friction}"
  armature="{armature}"/><inertial pos="0 0 0" mass="1" diaginertia="{0} {0} {0}"/></body>
</worldbody><actuator><velocity joint="j" kv="{kv}" forcerange="-{effort} {effort}"/></actuator>
</mujoco>"""

Engine = Callable[[Path, dict[str, float]], float]


def engine(name: str) -> Any:
    pytest.importorskip(name)
    return importlib.import_module(name)


def in_dart(folder: Path, figures: dict[str, float]) -> float:
    """[rad/s] With the values of SDF passed as by gz-physics; DART's parser of URDF reads fewer."""
    dart = engine("dartpy")
    path = folder / "wheel.urdf"
    path.write_text(URDF.format(INERTIA, **figures))
    world = dart.simulation.World()
    world.setTimeStep(STEP)
    world.setGravity([0.0, 0.0, 0.0])
    skeleton = dart.utils.DartLoader().parseSkeleton(f"file://{path}")
    world.addSkeleton(skeleton)
    joint = skeleton.getJoint("j")
    for sign, side in ((1.0, "Upper"), (-1.0, "Lower")):
        getattr(joint, f"setForce{side}Limit")(0, sign * figures["effort"])
        getattr(joint, f"setVelocity{side}Limit")(0, sign * figures["velocity"])
    joint.setDampingCoefficient(0, figures["damping"])
    joint.setCoulombFriction(0, figures["friction"])
    joint.setLimitEnforcement(True)
    joint.setActuatorType(dart.dynamics.ActuatorType.SERVO)
    for _ in range(STEPS):
        joint.setCommand(0, RATE)
        world.step()
    return float(joint.getVelocity(0))


def in_bullet(folder: Path, figures: dict[str, float], **how: float) -> float:
    """[rad/s] With the torque as argument, which is required."""
    bullet = engine("pybullet")
    path = folder / "wheel.urdf"
    path.write_text(URDF.format(INERTIA, **figures))
    client = bullet.connect(bullet.DIRECT)
    try:
        bullet.setTimeStep(STEP)
        flags = bullet.URDF_USE_INERTIA_FROM_FILE
        body = bullet.loadURDF(str(path), useFixedBase=True, flags=flags)
        bullet.changeDynamics(body, -1, angularDamping=0.0)  # which every body has besides
        mode = bullet.VELOCITY_CONTROL
        bullet.setJointMotorControl2(body, 0, mode, targetVelocity=RATE, **how)
        for _ in range(STEPS):
            bullet.stepSimulation()
        return float(bullet.getJointState(body, 0)[1])
    finally:
        bullet.disconnect(client)


def in_mujoco(_: Path, figures: dict[str, float], kv: float = 100.0) -> float:
    mujoco = engine("mujoco")
    model = mujoco.MjModel.from_xml_string(MJCF.format(INERTIA, step=STEP, kv=kv, **figures))
    data = mujoco.MjData(model)
    data.ctrl[0] = RATE
    for _step in range(STEPS):
        mujoco.mj_step(model, data)
    return float(data.qvel[0])


def with_torque(folder: Path, figures: dict[str, float]) -> float:
    return in_bullet(folder, figures, force=TORQUE)


# MuJoCo's own format has no limit of a joint's speed, and URDF and DART have no armature.
RUN: dict[str, tuple[Engine, tuple[str, ...]]] = {
    "gz": (in_dart, ("effort", "velocity", "damping", "friction")),
    "bullet": (with_torque, ("effort", "velocity", "damping", "friction")),
    "mujoco": (in_mujoco, ("effort", "damping", "friction", "armature")),
}


@pytest.mark.parametrize("name", RUN)
def test_the_torque_limit_speeds_a_wheel_up(name: str, tmp_path: Path) -> None:
    run, _ = RUN[name]
    expected = TORQUE * STEPS * STEP / INERTIA
    assert run(tmp_path, USUAL) == pytest.approx(expected, rel=0.002)  # DART's is 0.1 % more


@pytest.mark.parametrize("name", RUN)
def test_ignored_figures_change_nothing(name: str, tmp_path: Path) -> None:
    run, figures = RUN[name]
    usual = run(tmp_path, USUAL)
    for figure in figures:
        found = run(tmp_path, {**USUAL, figure: OTHER[figure]})
        if figure in ENGINES[name].ignored:
            assert found == usual, figure
        else:
            assert found < 0.95 * usual, figure


@pytest.mark.parametrize("name", ["gz", "bullet"])
def test_enough_torque_brings_the_speed_within_steps(name: str, tmp_path: Path) -> None:
    strong = {**USUAL, "effort": 1e4}
    found = in_dart(tmp_path, strong) if name == "gz" else in_bullet(tmp_path, strong)
    assert found == pytest.approx(RATE, rel=1e-6)


def test_bullet_has_unlimited_torque_unless_it_is_limited(tmp_path: Path) -> None:
    assert in_bullet(tmp_path, {**USUAL, "effort": 0.0}) == pytest.approx(RATE, rel=1e-6)


def test_mujoco_gives_kv_times_the_error(tmp_path: Path) -> None:
    """The error falls like exp(-kv t / I); implicit steps of 1 ms are off by 0.5 %."""
    found = in_mujoco(tmp_path, {**USUAL, "effort": 1e3}, kv=0.1)
    assert RATE - found == pytest.approx(RATE * 0.6065, rel=0.005)
