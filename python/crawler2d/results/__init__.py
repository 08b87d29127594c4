"""What came out of a run, as data: outcome, diagnosis, figures, history."""
