"""What several programs use: stored results, and measurements of time."""
