"""What tests execute of package and core: `make coverage`."""
