"""The seizure study: which track models get a robot over an edge, how often, and why not."""
