"""Coverage of package and core by tests: `make coverage`."""
