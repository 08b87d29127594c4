"""What a step costs as the robot, the ground, the threads and the time step grow."""
