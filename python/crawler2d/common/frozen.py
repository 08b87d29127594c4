"""Arrays and figures of a run that cannot be changed by accident."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Figures", "read_only"]


def read_only(array: NDArray[Any]) -> NDArray[Any]:
    """Return a view of an array that is read-only and cannot be made writeable again.

    NumPy lets a view be made writeable again if its base array, or the owner of the memory, is
    writeable. The owner of the core's memory never is; memory of any other owner is copied.
    """
    under = [array]
    while isinstance(under[-1].base, np.ndarray):
        under.append(under[-1].base)
    if not _is_the_cores(under[-1].base):
        under = [array.copy()]
    for each in under:
        each.flags.writeable = False
    return under[0].view()


def _is_the_cores(owner: object) -> bool:
    """Whether the memory belongs to the core, where no Python code can reach it."""
    if owner is None:
        return False
    try:
        memoryview(owner)  # type: ignore[arg-type]
    except TypeError:
        return True
    return False


class Figures(dict[str, float]):
    """Figures by name; they can be read, compared, copied and pickled as any dict.

    Examples
    --------
    >>> figures = Figures({"time": 2.5})
    >>> figures["time"] = 3.0
    Traceback (most recent call last):
        ...
    TypeError: these figures are read-only; dict(figures) is a copy that can be changed
    """

    __slots__ = ()

    def _refuse(self, *_: Any, **__: Any) -> NoReturn:
        """Raise, and say why."""
        raise TypeError("these figures are read-only; dict(figures) is a copy that can be changed")

    __setitem__ = __delitem__ = __ior__ = _refuse
    clear = pop = popitem = setdefault = update = _refuse

    def __reduce__(self) -> tuple[type[Figures], tuple[dict[str, float]]]:
        """Pickle and copy all figures at once, because single ones cannot be set."""
        return Figures, (dict(self),)
