"""One HTML page that replays a run, on its own or inside a notebook."""

from crawler2d.pictures.page.notebook import embedded
from crawler2d.pictures.page.replay import replay_page

__all__ = ["embedded", "replay_page"]
