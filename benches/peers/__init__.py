"""The same job in five engines: what a step costs, at their defaults and at equal accuracy."""
