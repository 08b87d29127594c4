"""The same task in five engines: cost per step, with defaults and at equal accuracy."""
