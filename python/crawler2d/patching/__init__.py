"""A model file with other wheels: the text as its author wrote it, changed only where they are."""
