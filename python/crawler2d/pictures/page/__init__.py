"""A run to look at: one HTML page that replays it, alone or inside a notebook."""

from crawler2d.pictures.page.replay import replay_page
from crawler2d.pictures.page.words import embedded

__all__ = ["embedded", "replay_page"]
