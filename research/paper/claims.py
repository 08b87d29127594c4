"""All claims of the paper, each with the experiment that settles it here, or why none can."""

from __future__ import annotations

from typing import TYPE_CHECKING

from research.paper import claims_ground as ground
from research.paper import claims_models as models
from research.paper.claim import Claim

if TYPE_CHECKING:
    from collections.abc import Sequence

    from research.paper.design import Work
    from research.paper.phases import Shaking

__all__ = ["claims"]

_NOT_HERE = (
    Claim(
        section="4, Table 3",
        text="the models turn at 2 to 4 revolutions a minute, the robot at 8.5",
        experiment="a side view has no turning",
    ),
    Claim(
        section="4.1.1",
        text="models with gears correspond to the real robot's dynamics and geometry better",
        experiment="no run of the real robot is given to compare with, but four figures; Table 3"
        " has them",
    ),
    Claim(
        section="2.3",
        text="segmental tracks are of low stability",
        experiment="stability of a simulator is one of its engine and its steps: chains of this"
        " project's own engine say nothing of others",
    ),
)


def claims(work: Work, shaken: Sequence[Shaking]) -> list[Claim]:
    """Settle every claim by runs.

    Parameters
    ----------
    work : Work
        By which means.
    shaken : sequence of Shaking
        What came of eq. (1).
    """
    print("Claims", flush=True)
    return [
        ground.gears_end_seizure(work),
        ground.chains_stick(work),
        ground.mass_sticks(work),
        *ground.lines_are_flat(work),
        ground.force_is_flat(work),
        models.geometry(),
        *models.costs(work),
        *models.shaking_of_gears(work, shaken),
        models.odometry_of_gears(work),
        *_NOT_HERE,
    ]
