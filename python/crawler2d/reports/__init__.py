"""The project's own studies, as programs of ``python -m crawler2d``.

Their robots are presets without rotors, as models for simulators are, but in the studies of drives:
all published figures were found so.
"""
