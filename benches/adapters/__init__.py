"""One adapter for each physics engine, and the input of the adapters."""
