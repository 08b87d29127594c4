"""Simulate many variants of one scenario, and evaluate the results."""
