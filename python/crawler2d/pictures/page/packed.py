"""Arrays as short text: base64 of 8 or 16 bit integers if fine enough, else of float32."""

from __future__ import annotations

import base64
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["packed"]


def packed(values: ArrayLike, resolution: float) -> dict[str, Any]:
    """Pack numbers for the page, flattened row by row; `unpacked` in data.js reverses it.

    Parameters
    ----------
    values : array_like
        Numbers; non-finite ones are kept.
    resolution : float
        Largest quantization step that the page may show, in the unit of the values.

    Returns
    -------
    dict
        `bits` per number and `data`; also `start` and `step` if the numbers are integer multiples.

    Examples
    --------
    >>> packed([0.0, 0.5, 1.0], resolution=0.1)
    {'bits': 8, 'data': 'AID/', 'start': 0.0, 'step': 0.00392156862745098}
    >>> packed([0.0, 1.0], resolution=1e-9)
    {'bits': 32, 'data': 'AAAAAAAAgD8='}
    """
    numbers = np.asarray(values, dtype=np.float64).ravel()
    low, high = (float(numbers.min()), float(numbers.max())) if numbers.size else (0.0, 0.0)
    for bits in (8, 16):
        step = (high - low) / (2**bits - 1)  # not finite if any number is not
        if step <= resolution:
            counts = np.rint((numbers - low) / step) if step > 0.0 else np.zeros(numbers.size)
            data = _text(counts.astype(f"<u{bits // 8}"))
            return {"bits": bits, "data": data, "start": low, "step": step}
    with np.errstate(over="ignore"):
        return {"bits": 32, "data": _text(numbers.astype("<f4"))}


def _text(array: np.ndarray[Any, Any]) -> str:
    return base64.b64encode(array.tobytes()).decode("ascii")
