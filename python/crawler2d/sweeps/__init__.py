"""Many variants of one scenario, and the statistics of what came out."""
