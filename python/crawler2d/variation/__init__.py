"""Distributions of what varies from run to run, and of what is unknown, by path of a field."""
