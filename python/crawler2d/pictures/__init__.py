"""What came out of a run, to look at: figures and a page that replays it."""
