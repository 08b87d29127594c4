"""What everything else builds on: arrays, tables, units, optional packages."""
