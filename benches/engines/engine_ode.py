"""Open Dynamics Engine, in a child process that runs an interpreter which has it."""

from __future__ import annotations

from dataclasses import asdict

from benches.engines.engine import Scene
from benches.models.ode_child import VERSION, Child, Setting, require

__all__ = ["Ode"]


class Ode:
    """ODE's quick step, whose friction is a pyramid.

    Parameters
    ----------
    setting : Setting
        How it is set.

    Raises
    ------
    ImportError
        If no interpreter has it.
    """

    in_space = True

    def __init__(self, setting: Setting) -> None:
        require()
        self.setting = setting
        self.time_step = setting.time_step
        self.version = VERSION

    def world(self, scene: Scene) -> Child:
        """Build a world."""
        return Child(
            self.setting,
            bodies=scene.robot.plain(),
            ground=[asdict(block) for block in scene.ground],
            friction=scene.friction,
            x=scene.x,
            z=scene.z,
            angle=scene.angle,
            phase=scene.phase,
        )
