"""From scenarios to runs, and what can be done with a run."""
