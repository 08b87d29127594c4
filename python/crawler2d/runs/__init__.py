"""Simulate scenarios, and use the resulting runs."""
