"""ODE, which reads no model files: it gets the bodies of the tree that was read."""

from __future__ import annotations

from dataclasses import asdict, replace

from benches.models.engine import Scene, Touch, check
from benches.models.lumps import lumps
from benches.models.ode_child import VERSION, Child, Setting, require
from crawler2d.model_tree import Pose

__all__ = ["Ode"]

_TORQUE = 1e4  # [N m] of every motor: files of wheels have no limit that they would reach


class Ode:
    """ODE's quick step, whose friction is a pyramid; flippers are parts of the chassis.

    Parameters
    ----------
    setting : Setting
        How it is set.
    time_step : float, optional
        [s] Other than that of the setting.

    Raises
    ------
    ImportError
        If no interpreter has it.
    """

    name = "ODE"
    version = VERSION

    def __init__(self, setting: Setting, time_step: float | None = None) -> None:
        require()
        self.setting = setting if time_step is None else replace(setting, time_step=time_step)
        self.time_step = self.setting.time_step

    def world(self, scene: Scene) -> OdeWorld:
        """Build a world."""
        return OdeWorld(scene, self.setting)


class OdeWorld:
    """A robot on its ground in ODE."""

    def __init__(self, scene: Scene, setting: Setting) -> None:
        bodies = lumps(scene.model, _TORQUE)
        mass = sum(body["mass"] for body in bodies)
        check(scene.model, mass, {body["name"]: body["shapes"][0]["place"] for body in bodies[1:]})
        self._speed = 0.0
        self._child = Child(
            setting,
            bodies=bodies,
            ground=[asdict(box) | {"yaw": 0.0} for box in scene.ground],
            friction=scene.friction,
            x=scene.x,
            z=-scene.model.lowest,
            angle=0.0,
            phase=scene.phase,
        )

    def command(self, speed: float) -> None:
        """Let the motors turn all wheels so that their surfaces run at a speed [m/s]."""
        self._speed = speed

    def advance(self) -> None:
        """Take a step."""
        self._child.advance([self._speed])

    def pose(self) -> Pose:
        """Return where the chassis frame is."""
        return self._child.pose()

    def touches(self) -> list[Touch]:
        """Return the contacts with the ground; ODE's module does not say how hard they push."""
        return [Touch(**touch, force=float("nan")) for touch in self._child.touches()]

    def bend(self) -> float:
        """[rad] Return by how much the worst flipper is off its angle: they are of the chassis."""
        return 0.0

    def close(self) -> None:
        """Free what the world holds."""
        self._child.close()
