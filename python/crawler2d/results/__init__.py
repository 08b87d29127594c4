"""Results of a run as data: outcome, diagnosis, metrics, history."""
