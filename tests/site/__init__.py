"""The documentation site: what it must hold, without building it."""
