"""One adapter for each physics engine, and what the adapters are given."""
