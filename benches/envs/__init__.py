"""Steps of environments a second."""
