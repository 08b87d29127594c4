"""Robots of the literature and terrains of every kind, ready made."""
