"""Common parts of several programs: stored results, and measurements of time."""
