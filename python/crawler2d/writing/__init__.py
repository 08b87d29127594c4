"""Write robots as three-dimensional model files in SDF, URDF and MJCF."""
