"""The project's own studies, as programs of ``python -m crawler2d``."""
