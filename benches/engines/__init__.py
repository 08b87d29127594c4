"""The same scenarios in crawler2d and in other physics engines, in the plane and in space."""
