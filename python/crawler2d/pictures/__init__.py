"""Figures of runs and studies, and pages that replay runs."""
