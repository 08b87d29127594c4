"""How well crawler2d's own dynamics and rapier's agree, on random robots."""
