"""From a robot to a model file in three dimensions, in the words of each format."""
