"""The engines by name, each at a setting, and which cells they can hold."""

from __future__ import annotations

from dataclasses import dataclass

from benches.engines.cells import Cell
from benches.engines.engine import Engine
from benches.models import ode_child

__all__ = ["ENGINES", "FINE", "Entry", "engine_of", "holds"]


@dataclass(frozen=True, slots=True)
class Entry:
    """A column of the comparison.

    Parameters
    ----------
    what : str
        The engine and its setting, in words.
    is_fine : bool
        Whether the setting is as fine as it was found to converge.
    in_space : bool
        Whether it has three dimensions.
    starts : int
        Runs of a cell that are made unless another number is asked for: what it costs decides.
    """

    what: str
    is_fine: bool
    in_space: bool
    starts: int


ENGINES: dict[str, Entry] = {
    "pymunk": Entry("Chipmunk, finely", True, False, 8),
    "rapier": Entry("crawler2d's second backend", True, False, 3),
    "ode": Entry("ODE as Gazebo classic sets it", False, True, 8),
    "ode-fine": Entry("ODE, finely", True, True, 3),
    "bullet": Entry("Bullet as PyBullet sets it", False, True, 6),
    "bullet-fine": Entry("Bullet, finely", True, True, 3),
    "dart": Entry("DART as gz-sim sets it", False, True, 3),
    "dart-fine": Entry("DART with Coulomb's law", True, True, 1),
}
"""The columns, in the order in which they run."""

FINE = tuple(name for name, entry in ENGINES.items() if entry.is_fine)


def engine_of(name: str) -> Engine:
    """Return an engine; rapier is crawler2d's.

    Raises
    ------
    ImportError
        If it is not installed.
    """
    if name == "pymunk":
        from benches.engines.engine_pymunk import Pymunk  # noqa: PLC0415 - loads Chipmunk

        return Pymunk()
    if name.startswith("ode"):
        from benches.engines.engine_ode import Ode  # noqa: PLC0415 - only for ODE

        return Ode(ode_child.GAZEBO if name == "ode" else ode_child.FINE)
    if name.startswith("bullet"):
        from benches.engines import engine_bullet  # noqa: PLC0415 - loads Bullet

        return engine_bullet.Bullet(
            engine_bullet.PYBULLET if name == "bullet" else engine_bullet.FINE
        )
    from benches.engines import engine_dart  # noqa: PLC0415 - loads DART

    return engine_dart.Dart(engine_dart.GZ if name == "dart" else engine_dart.FINE)


def holds(name: str, cell: Cell) -> bool:
    """Whether an engine can hold a cell.

    A ground that is not the same across needs three dimensions. The limit of one motor a track
    needs gears between wheels, which only Chipmunk has here.
    """
    return not cell.is_coupled if ENGINES[name].in_space else cell.is_even
