"""Change the wheels in the text of a model file, and nothing else."""
