"""Results of a run, as data: outcome, diagnosis, figures, history."""
