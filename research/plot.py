"""The figures of the seizure study: success over height, vibration over phase, the post."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from crawler2d.common.extras import extra

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.figure import Figure

    from crawler2d.runs.run import Run
    from research.tables import Cell, Phase

__all__ = ["plot_phases", "plot_posts", "plot_rates"]

# Okabe and Ito's palette, which colour-blind readers can tell apart.
_BLUE, _ORANGE, _GREEN = "#0072B2", "#E69F00", "#009E73"
_COLORS = (_BLUE, _ORANGE, _GREEN)
_MARKERS = ("o", "s", "^")
# Wide lines below narrow ones, so that coinciding lines stay visible.
_WIDTHS = (3.2, 2.0, 0.9)
_COLUMNS = 4
_EQUATION_1 = 1.0 / 3.0


def plot_rates(cells: Sequence[Cell]) -> Figure:
    """Draw the rates of one robot with their intervals, one panel per model.

    Parameters
    ----------
    cells : sequence of Cell
        Heights ascending within a model and an obstacle; up to three obstacles.

    Returns
    -------
    Figure
        Not shown and not saved.

    Raises
    ------
    ImportError
        If matplotlib is missing; the message names the extra to install.
    """
    figures = extra("matplotlib.figure", "plot")
    models = list(dict.fromkeys(cell.model for cell in cells))
    obstacles = list(dict.fromkeys(cell.obstacle for cell in cells))
    columns = min(_COLUMNS, len(models))
    rows = -(-len(models) // columns)
    size = (2.2 * columns, 1.9 * rows + 0.9)
    styles: list[dict[str, Any]] = [
        {"color": color, "marker": marker, "linewidth": width, "markersize": 2.0 + width}
        for color, marker, width in zip(_COLORS, _MARKERS, _WIDTHS, strict=True)
    ]
    figure: Figure = figures.Figure(figsize=size, layout="constrained")
    axes = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for index, ax in enumerate(axes.flat):
        if index >= len(models):
            ax.set_visible(False)
            continue
        for obstacle, style in zip(obstacles, styles, strict=False):
            own = [c for c in cells if (c.model, c.obstacle) == (models[index], obstacle)]
            heights = [1e3 * cell.height for cell in own]
            lows, highs = [1e2 * cell.low for cell in own], [1e2 * cell.high for cell in own]
            ax.fill_between(heights, lows, highs, color=style["color"], alpha=0.15, linewidth=0.0)
            ax.plot(heights, [1e2 * cell.rate for cell in own], label=obstacle, **style)
        ax.set_title(models[index], fontsize="medium")
        ax.set_ylim(-5.0, 105.0)
        ax.grid(alpha=0.25)
        if index % columns == 0:
            ax.set_ylabel("cleared [%]")
        if index + columns >= len(models):
            ax.set_xlabel("height [mm]")
            ax.tick_params(labelbottom=True)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    count = max(cell.count for cell in cells)
    figure.suptitle(f"Engineer without flippers: {count} runs per point, 95 % Wilson intervals")
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure


def plot_phases(phases: Sequence[Phase]) -> Figure:
    """Draw the vibration of lines of gear wheels on flat ground over their phases.

    Parameters
    ----------
    phases : sequence of Phase
        Phase fractions ascending within a count; up to three counts.

    Returns
    -------
    Figure
        Not shown and not saved.

    Raises
    ------
    ImportError
        If matplotlib is missing; the message names the extra to install.
    """
    figures = extra("matplotlib.figure", "plot")
    figure: Figure = figures.Figure(figsize=(8.0, 3.6), layout="constrained")
    vertical, angular = figure.subplots(1, 2, sharex=True)
    counts = dict.fromkeys(phase.count for phase in phases)
    for count, color, marker in zip(counts, _COLORS, _MARKERS, strict=False):
        own = [phase for phase in phases if phase.count == count]
        fractions = [phase.phase_fraction for phase in own]
        for ax, heights in (
            (vertical, [phase.vertical_acceleration for phase in own]),
            (angular, [phase.angular_velocity for phase in own]),
        ):
            label = f"{count} gear wheels"
            ax.plot(fractions, heights, color=color, marker=marker, markersize=4, label=label)
    for ax in (vertical, angular):
        ax.axvline(_EQUATION_1, color="#222222", linestyle=":", label="eq. (1)")
        ax.set(xlabel="phase fraction", ylim=(0.0, None))
        ax.grid(alpha=0.25)
    vertical.set_ylabel("vertical acceleration, rms [m/s²]")
    angular.set_ylabel("rate of the chassis angle, rms [rad/s]")
    handles, labels = vertical.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(labels))
    return figure


def plot_posts(runs: Mapping[tuple[float, bool], Run]) -> Figure:
    """Draw where the public wheel model stopped at a post, one panel per run.

    Parameters
    ----------
    runs : mapping of (float, bool) to Run
        What `public_wheel_model` returned; runs that cleared are left out.

    Returns
    -------
    Figure
        Not shown and not saved.

    Raises
    ------
    ImportError
        If matplotlib is missing; the message names the extra to install.
    """
    figures = extra("matplotlib.figure", "plot")
    stuck = {place: run for place, run in runs.items() if run.outcome != "cleared"}
    rows = -(-len(stuck) // 2)
    figure: Figure = figures.Figure(figsize=(8.0, 2.2 * rows), layout="constrained")
    axes = figure.subplots(rows, 2, sharex=True, sharey=True, squeeze=False)
    for ax, ((height, belly), run) in zip(axes.flat, stuck.items(), strict=False):
        run.plot(ax, time=run.time[-1])
        built = "belly" if belly else "no belly"
        title = f"post of {1e3 * height:.0f} mm, {built}: {run.outcome}"
        ax.set_title(title, loc="left", fontsize="medium")
        ax.set(xlim=(-0.42, 0.22), ylim=(-0.03, 0.23))
        ax.label_outer()
        ax.get_legend().remove()
    return figure
