"""The same job in five engines: cost per step, at their defaults and at equal accuracy."""
