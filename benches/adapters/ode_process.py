"""Open Dynamics Engine in a separate process: its quick step, with a friction pyramid.

ODE reads no model files: it gets the rigid bodies of a robot, flippers as parts of the chassis.
"""

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

from benches.adapters.space import Scene, Touch, World, check
from crawler2d.model_tree import Pose

_WORKER = Path(__file__).with_name("ode_worker.py")
_CANDIDATES = (sys.executable, "/usr/bin/python3")


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


@dataclass(frozen=True, kw_only=True)
class Ode:
    """ODE at a setting, by default a fine one.

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

    Raises
    ------
    ImportError
        If no interpreter has ODE.
    """

    time_step: float = 5e-4
    iterations: int = 150
    cfm: float = 1e-8
    erp: float = 0.2
    layer: float = 1e-5
    correcting: float = 0.1
    soft_cfm: float = 1e-8
    soft_erp: float = 0.2

    version = "ODE 0.16"
    in_space = True

    def __post_init__(self) -> None:
        """Look for an interpreter."""
        if interpreter() is None:
            raise ImportError("no interpreter has the module ode (Debian: python3-pyode)")

    def world(self, scene: Scene) -> OdeWorld:
        """Build a world."""
        return OdeWorld(scene, self)


_KP, _KD, _STEP = 0.5e12, 2.0, 1e-3  # two surfaces of 1e12 N/m and 1 N s/m, in series and parallel

GAZEBO = {
    "time_step": _STEP,
    "iterations": 50,
    "cfm": 0.0,
    "layer": 0.0,
    "correcting": 0.01,
    "soft_cfm": 1.0 / (_STEP * _KP + _KD),
    "soft_erp": _STEP * _KP / (_STEP * _KP + _KD),
}
"""Setting of Gazebo classic: its `min_depth` and `max_vel` of a link replace layer and speed."""


class OdeWorld(World):
    """A robot on its ground in ODE."""

    def __init__(self, scene: Scene, setting: Ode) -> None:
        bodies = scene.robot.bodies
        mass = sum(body["mass"] for body in bodies)
        check(scene.robot, mass, {body["name"]: body["shapes"][0]["place"] for body in bodies[1:]})
        self._process = subprocess.Popen(
            [interpreter() or "", str(_WORKER)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self._answer = self._ask(
            do="build",
            setting=asdict(setting),
            bodies=bodies,
            ground=[asdict(block) for block in scene.ground],
            friction=scene.friction,
            x=scene.x,
            z=scene.z,
            angle=scene.angle,
            phase=scene.phase,
        )

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
        """Take a step for each set-point."""
        self._answer = self._ask(do="advance", speeds=list(speeds))

    def pose(self) -> Pose:
        """Return the pose of the chassis frame."""
        turn = np.array(self._answer["turn"]).reshape(3, 3)
        return Pose(place=np.array(self._answer["place"]), turn=turn)

    def touches(self) -> list[Touch]:
        """Return the contacts of the last step; ODE's module does not report their forces."""
        touches = self._ask(do="touches")["touches"]
        return [Touch(**touch, force=float("nan")) for touch in touches]

    def close(self) -> None:
        """End the process."""
        for pipe in (self._process.stdin, self._process.stdout):
            assert pipe is not None
            pipe.close()
        self._process.wait(timeout=10)
