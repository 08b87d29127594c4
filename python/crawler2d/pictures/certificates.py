"""A certificate: regions of one field or two, by what is known of each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from crawler2d.common.extras import extra
from crawler2d.drawings.canvas import axes_or_new
from crawler2d.drawings.palette import BLACK, GRAY, GREEN, PALE, RED
from crawler2d.errors import ScenarioError
from crawler2d.pictures.rates import legend_below
from crawler2d.sweeps.axes import field_attributes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from crawler2d.studies.certify import Certificate

__all__ = ["plot_certificate"]

_LOOKS: dict[str, tuple[dict[str, Any], str]] = {
    "certified": ({"facecolor": GREEN, "hatch": None}, "no jam: certified"),
    "as a belt": ({"facecolor": PALE, "hatch": "\\\\"}, "a belt can jam, too"),
    "jams": ({"facecolor": RED, "hatch": "...."}, "it can jam"),
    "undecided": ({"facecolor": "white", "hatch": None}, "undecided"),
}
"""How regions of a status are drawn, and what that is in the legend."""


def plot_certificate(certificate: Certificate, ax: Axes | None) -> Axes:
    """Draw the regions of a certificate as rectangles; over one field they are bars.

    Raises
    ------
    ScenarioError
        If more than two fields vary.
    """
    count = len(certificate.fields)
    if count > 2:
        raise ScenarioError("plot", certificate.fields, "must vary one field or two")
    ax = axes_or_new(ax, (8.0, 6.0))
    patches = extra("matplotlib.patches", "plot")
    handles = {}
    for low, high, status in zip(
        certificate.low, certificate.high, certificate.status, strict=True
    ):
        style, text = _LOOKS[str(status)]
        top, bottom = (high[1], low[1]) if count == 2 else (1.0, 0.0)
        look = {**style, "edgecolor": BLACK if style["hatch"] else GRAY, "linewidth": 0.2}
        size = high[0] - low[0], top - bottom
        ax.add_patch(patches.Rectangle((low[0], bottom), *size, **look))
        handles.setdefault(text, patches.Patch(label=text, **look))
    ax.set(xlim=certificate.ranges[0], xlabel=_label(certificate.fields[0]))
    if count == 2:
        ax.set(ylim=certificate.ranges[1], ylabel=_label(certificate.fields[1]))
    else:
        ax.set(ylim=(0.0, 1.0), yticks=())
    inside = f"{1e3 * certificate.depth:g} mm of ground or more inside the track"
    text = f"where it can stand still with its drives running, with {inside}"
    ax.set_title(text, loc="left", fontsize="small", parse_math=False)
    legend_below(ax, handles=list(handles.values()))
    return ax


def _label(path: str) -> str:
    attributes = field_attributes([path])
    unit = attributes.get("units", "1")
    return attributes["long_name"] + (f" [{unit}]" if unit not in ("", "1") else "")
