"""From a public model file to a robot, with the file and line of every figure."""
