"""What is written on figures of tables: units that people read, and populations in its title."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray

__all__ = ["populations", "readable"]

_SCALES = {"m": (1e3, "mm"), "rad": (180.0 / np.pi, "deg")}
"""Factor and unit in which people read a quantity."""


def readable(values: xarray.DataArray) -> tuple[float, str]:
    """Return the factor to the unit in which people read an array, and its name with that unit."""
    given = values.attrs.get("units", "")
    factor, unit = _SCALES.get(given, (1.0, given))
    name = str(values.attrs.get("long_name", values.name))
    return factor, name if unit in ("", "1") else f"{name} [{unit}]"


def populations(attributes: Mapping[str, Any], *, banded: bool, what: str = "rates") -> str:
    """Say what rates are rates of, in the words of a figure's title."""
    varied = _named(attributes.get("vary", attributes.get("varied", "")))
    text = f"{what} over {varied}" if varied else f"{what} of equal runs"
    unknown = _named(attributes.get("unknown", ""))
    if banded:
        return f"{text};\nmedian and 5 to 95 % over {unknown}"
    kind = attributes.get("interval", "")
    level = attributes.get("confidence_level")
    return f"{text}\n{kind} intervals, {100 * level:.0f} %" if level else text


def _named(text: str) -> str:
    """Name the fields of ``path: distribution; path: distribution``."""
    paths = [part.partition(":")[0] for part in text.split("; ") if part]
    names = [re.sub(r"\[[^\]]*\]", "", path.rpartition(".")[2]) for path in paths]
    return ", ".join(dict.fromkeys(name.replace("_", " ") for name in names))
