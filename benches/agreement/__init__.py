"""Agreement of crawler2d's own dynamics and rapier's on random robots."""
