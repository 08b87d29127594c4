"""A run to look at: one HTML page that replays it, alone or inside a notebook."""

from crawler2d.pictures.page.notebook import embedded
from crawler2d.pictures.page.replay import replay_page

__all__ = ["embedded", "replay_page"]
