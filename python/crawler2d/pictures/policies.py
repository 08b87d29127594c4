"""The figure of an audit of a policy: a table of rates by model and obstacle."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from crawler2d.common.extras import extra
from crawler2d.drawings.canvas import axes_or_new, set_title
from crawler2d.drawings.palette import BLACK, GRAY, GREEN, RED
from crawler2d.errors import ScenarioError

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

__all__ = ["plot_policy"]

_CELL = 1.7, 0.75
"""[inch] Width and height."""
_MARGIN = 1.9, 1.6
"""[inch] For the names of models and obstacles, and the title."""

_LOST = 2.5
"""[point] Width of the frame of a cell where a gain is lost."""


def plot_policy(data: xarray.Dataset, ax: Axes | None) -> Axes:
    """Draw a table of the rates of policy and baseline, and of the commonest other outcome.

    Cells are greener for a higher rate of the policy. A red frame marks a significant loss of the
    gain on the first model.
    """
    if data["gain"].ndim != 2 or data.sizes.get("driver") != 2:
        rule = "must have models, obstacles and both drivers"
        raise ScenarioError("plot", str(dict(data.sizes)), rule)
    models, obstacles = (data[name].to_numpy().tolist() for name in ("model", "obstacle"))
    first = data.attrs.get("first_model", models[0])
    if models[0] != first:
        rule = f"must begin with {first}, on which the policy was trained"
        raise ScenarioError("plot", models, rule)
    size = [each * len(n) for each, n in zip(_CELL, (obstacles, models), strict=True)]
    ax = axes_or_new(ax, (size[0] + _MARGIN[0], size[1] + _MARGIN[1]))
    colors = extra("matplotlib.colors", "plot").LinearSegmentedColormap.from_list(
        "rates", ["white", GREEN]
    )
    rates = data["rate"].transpose("driver", "model", "obstacle").to_numpy()
    ax.imshow(rates[0], cmap=colors, vmin=0.0, vmax=1.6, aspect="auto")  # text stays readable
    gained = data["gain_low"].transpose("model", "obstacle").to_numpy()[0] > 0.0
    patch = extra("matplotlib.patches", "plot").Rectangle
    for row, model in enumerate(models):
        for column, obstacle in enumerate(obstacles):
            cell = data.sel(model=model, obstacle=obstacle)
            ours, theirs = rates[:, row, column]
            about: Any = {"ha": "center", "va": "center", "color": BLACK}
            ax.text(column, row - 0.15, f"{ours:.0%} ({theirs:.0%})", weight="bold", **about)
            ending = cell["ending"].item()
            ax.text(column, row + 0.22, ending, fontsize="x-small", parse_math=False, **about)
            if gained[column] and cell["lost_low"] > 0.0:
                place = (column - 0.47, row - 0.46)
                frame: Any = {"fill": False, "edgecolor": RED, "linewidth": _LOST}
                ax.add_patch(patch(place, 0.94, 0.92, **frame))
    ax.set_xticks(range(len(obstacles)), list(map(str, obstacles)), parse_math=False)
    ax.set_yticks(range(len(models)), list(map(str, models)), parse_math=False)
    ax.tick_params(length=0)
    for edge in range(1, len(models)):
        ax.axhline(edge - 0.5, color=GRAY, linewidth=0.8)
    for edge in range(1, len(obstacles)):
        ax.axvline(edge - 0.5, color=GRAY, linewidth=0.8)
    ax.set(xlabel="obstacle", ylabel="track model")
    repeats = data.sizes["repeat"]
    text = f"Clearing rates of policy and baseline ({repeats} runs each), commonest other outcome."
    set_title(ax, f"{text} Red: some of the gain on {models[0]} is lost.")
    return ax
