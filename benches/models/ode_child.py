"""Open Dynamics Engine: how it is set, and a child process with an interpreter that has it."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from crawler2d.model_tree import Link, Pose, Shape

__all__ = [
    "FINE",
    "GAZEBO",
    "VERSION",
    "Child",
    "Setting",
    "interpreter",
    "plain_body",
    "require",
]

VERSION = "ODE 0.16"

_WORKER = Path(__file__).with_name("ode_worker.py")
_CANDIDATES = (sys.executable, "/usr/bin/python3")


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """How ODE's quick step is set.

    Parameters
    ----------
    time_step : float
        [s] Of a step.
    iterations : int
        Of its solver.
    cfm, erp : float
        [s^2/kg], [-] Constraint force mixing and error reduction of joints.
    layer : float
        [m] Depth up to which contacts are left alone.
    correcting : float
        [m/s] Largest speed at which a penetration is pushed out.
    soft_cfm, soft_erp : float
        Those of contacts.
    """

    time_step: float
    iterations: int
    cfm: float
    erp: float
    layer: float
    correcting: float
    soft_cfm: float
    soft_erp: float


_KP, _KD, _STEP = 0.5e12, 2.0, 1e-3  # two surfaces of 1e12 N/m and 1 N s/m, in series and beside

GAZEBO = Setting(
    time_step=_STEP,
    iterations=50,
    cfm=0.0,
    erp=0.2,
    layer=0.0,
    correcting=0.01,
    soft_cfm=1.0 / (_STEP * _KP + _KD),
    soft_erp=_STEP * _KP / (_STEP * _KP + _KD),
)
"""Gazebo classic's: its `min_depth` and `max_vel` of a link stand in place of layer and speed."""

FINE = Setting(
    time_step=5e-4,
    iterations=150,
    cfm=1e-8,
    erp=0.2,
    layer=1e-5,
    correcting=0.1,
    soft_cfm=1e-8,
    soft_erp=0.2,
)


@cache
def interpreter() -> str | None:
    """Return an interpreter that has ODE, or None.

    Examples
    --------
    >>> interpreter() in (None, sys.executable, "/usr/bin/python3")
    True
    """
    for path in dict.fromkeys(_CANDIDATES):
        try:
            done = subprocess.run(
                [path, "-c", "import ode"], capture_output=True, check=False, timeout=60
            )
        except OSError:
            continue
        if done.returncode == 0:
            return path
    return None


def require() -> str:
    """Return an interpreter that has ODE.

    Raises
    ------
    ImportError
        If none has it.
    """
    path = interpreter()
    if path is None:
        raise ImportError("no interpreter has the module ode (Debian: python3-pyode)")
    return path


def plain_body(
    link: Link, axle: Sequence[float] | None, radius: float | None, torque: float | None
) -> dict[str, Any]:
    """Write a link as the worker takes it, in the chassis frame; rotations are row by row.

    Parameters
    ----------
    link : Link
        The body.
    axle : sequence of float, optional
        [m] Of a wheel.
    radius : float, optional
        [m] Of a wheel.
    torque : float, optional
        [N m] Limit of its motor.
    """
    return {
        "name": link.name,
        "mass": link.mass,
        "center": link.center.tolist(),
        "inertia": link.inertia.ravel().tolist(),
        "shapes": [_shape(shape) for shape in link.shapes],
        "axle": None if axle is None else list(axle),
        "radius": radius,
        "torque": torque,
    }


def _shape(shape: Shape) -> dict[str, Any]:
    pose: Pose = shape.pose
    return {
        "kind": shape.kind,
        "place": pose.place.tolist(),
        "turn": pose.turn.ravel().tolist(),
        "radius": shape.radius,
        "length": shape.length,
        "size": shape.size.tolist(),
    }


class Child:
    """A robot on its ground in a process of its own.

    Parameters
    ----------
    setting : Setting
        How ODE is set.
    scene : Any
        Keywords for the worker's `World`: robot, ground and start.

    Raises
    ------
    ImportError
        If no interpreter has ODE.
    """

    def __init__(self, setting: Setting, **scene: Any) -> None:
        self._process = subprocess.Popen(
            [require(), str(_WORKER)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self._answer = self._ask(do="build", setting=asdict(setting), **scene)

    def _ask(self, **message: Any) -> dict[str, Any]:
        stdin, stdout = self._process.stdin, self._process.stdout
        assert stdin is not None
        assert stdout is not None
        stdin.write(json.dumps(message) + "\n")
        stdin.flush()
        line = stdout.readline()
        if not line:
            raise RuntimeError(f"ODE's process ended with {self._process.wait()}")
        answer: dict[str, Any] = json.loads(line)
        return answer

    def advance(self, speeds: Sequence[float]) -> None:
        """Take a step for each set-point of the speed of all surfaces [m/s]."""
        self._answer = self._ask(do="advance", speeds=list(speeds))

    def pose(self) -> Pose:
        """Return where the chassis frame is."""
        turn = np.array(self._answer["turn"]).reshape(3, 3)
        return Pose(place=np.array(self._answer["place"]), turn=turn)

    def touches(self) -> list[dict[str, Any]]:
        """Return body, point [m] and normal of each contact of the last step."""
        found: list[dict[str, Any]] = self._ask(do="touches")["touches"]
        return found

    def close(self) -> None:
        """End the process."""
        for pipe in (self._process.stdin, self._process.stdout):
            assert pipe is not None
            pipe.close()
        self._process.wait(timeout=10)
