"""Foundations: arrays, tables, units, optional packages."""
