"""What everything else stands on: arrays, tables, units, optional packages."""
