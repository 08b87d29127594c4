"""Gymnasium environments in which a policy drives a robot over obstacles, and their audit.

Importing this module registers ``crawler2d/FlipperClimb-v0`` and ``crawler2d/StepField-v0``.

>>> import gymnasium
>>> import crawler2d.envs
>>> env = gymnasium.make("crawler2d/FlipperClimb-v0")
>>> observation, info = env.reset(seed=1)
>>> observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
>>> many = gymnasium.make_vec("crawler2d/FlipperClimb-v0", num_envs=4)
>>> many.reset(seed=1)[0].shape == (4, *observation.shape)
True
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crawler2d.common.extras import extra

if TYPE_CHECKING:
    import gymnasium
else:
    gymnasium = extra("gymnasium", "gym")

from crawler2d.envs.flipper_env import FlipperEnv
from crawler2d.envs.flipper_vector_env import FlipperVectorEnv
from crawler2d.envs.policy_audit import audit_policy

__all__ = ["FlipperEnv", "FlipperVectorEnv", "audit_policy"]


def __dir__() -> list[str]:
    """List what is public, for completion."""
    return sorted(__all__)


_IDS = {"FlipperClimb-v0": "flipper_climb", "StepField-v0": "step_field"}
"""Map each id to the name of its scenario."""

for _name, _scenario in _IDS.items():
    gymnasium.register(
        f"crawler2d/{_name}",
        entry_point="crawler2d.envs:FlipperEnv",
        vector_entry_point="crawler2d.envs:FlipperVectorEnv",
        kwargs={"scenario": _scenario},
    )
