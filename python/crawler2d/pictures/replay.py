"""The page of a run as a widget of a notebook. It needs anywidget; imported on first use."""

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
        [s] The instant that is shown. It follows the replay, which goes where it is set.
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
        """Replay another run in its place."""
        self.page = replay_page(run)
