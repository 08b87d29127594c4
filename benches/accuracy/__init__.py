"""A convergence study over all track models, at heights where some runs clear and some do not."""
