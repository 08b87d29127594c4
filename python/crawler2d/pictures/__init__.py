"""Pictures of a run: figures, and a page that replays it."""
