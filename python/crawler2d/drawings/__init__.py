"""Outlines of robot and ground in figures, SVG and notebooks, from plain data."""
