"""What comes back of a run is not changed by accident: arrays and figures that refuse to be."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Figures", "read_only"]


def read_only(array: NDArray[Any]) -> NDArray[Any]:
    """View an array without the right to write, and without a way to give it back.

    NumPy lets a view be written to again if an array under it can be, or the owner of its memory.
    The core's memory has no owner that could; any other may be someone else's, and is copied.
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
    """Tell the owner of memory that no Python code can reach from arrays that own theirs."""
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
    TypeError: these figures cannot be changed; dict(figures) is a copy that can
    """

    __slots__ = ()

    def _refuse(self, *_: Any, **__: Any) -> NoReturn:
        """Say why not."""
        raise TypeError("these figures cannot be changed; dict(figures) is a copy that can")

    __setitem__ = __delitem__ = __ior__ = _refuse
    clear = pop = popitem = setdefault = update = _refuse

    def __reduce__(self) -> tuple[type[Figures], tuple[dict[str, float]]]:
        """Pickle and copy the figures as a whole: one by one they cannot be set."""
        return Figures, (dict(self),)
