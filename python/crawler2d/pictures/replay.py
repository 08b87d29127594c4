"""The page of a run as a widget for notebooks, imported on first use because of anywidget."""

from __future__ import annotations

from typing import TYPE_CHECKING

from crawler2d.common.extras import extra
from crawler2d.pictures.page import FRAME_HEIGHT, read_part, replay_page

if TYPE_CHECKING:
    from crawler2d.results.record import Record

__all__ = ["Replay"]

anywidget, traitlets = (extra(name, "notebook") for name in ("anywidget", "traitlets"))


class Replay(anywidget.AnyWidget):  # type: ignore[misc, name-defined] # untyped
    """The replay of a run in a notebook; see `Run.widget`.

    Parameters
    ----------
    run : Run
        A run with history.
    time : float, optional
        [s] Instant at which it opens, as for `Run.to_html`.

    Attributes
    ----------
    time : float
        [s] The instant that is shown. The replay updates it, and jumps to it when it is set.
    page : str
        The page that is shown.
    """

    _esm = read_part("widget.js")
    page = traitlets.Unicode().tag(sync=True)
    time = traitlets.Float(0.0).tag(sync=True)
    height = traitlets.Int(FRAME_HEIGHT).tag(sync=True)

    def __init__(self, run: Record, time: float | None = None) -> None:
        super().__init__(page=replay_page(run, time))

    def show(self, run: Record) -> None:
        """Replace the run by another one."""
        self.page = replay_page(run)
