"""What is not the same in every run, and what is not known: distributions by path of a field."""
