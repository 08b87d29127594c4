"""Where in a file something stands."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["MADE", "Where"]


@dataclass(frozen=True, slots=True)
class Where:
    """A line of a file.

    Parameters
    ----------
    file : str
        Its name.
    line : int
        Number of the line, from 1.

    Examples
    --------
    >>> print(Where("robot.sdf", 12))
    robot.sdf:12
    """

    file: str
    line: int

    def __str__(self) -> str:
        """Return file and line as compilers write them."""
        return f"{self.file}:{self.line}"


MADE = Where("", 0)
"""Of what was made, not read."""
