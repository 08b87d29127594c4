"""What is simulated, as frozen dataclasses: robot, track, terrain, command and settings."""
