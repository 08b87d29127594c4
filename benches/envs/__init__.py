"""Steps of environments per second."""
