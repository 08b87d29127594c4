"""Read robots from model files, with the file and line of every figure."""
