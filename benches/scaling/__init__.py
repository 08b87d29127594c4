"""How the cost of a step grows with robot, ground, threads and time step."""
