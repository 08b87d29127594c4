"""
The highest obstacle
====================

Every height is tried until its rate is known: a lower step may stop wheels that get over a higher
one.
"""

import crawler2d as c2d

robot = c2d.robots.engineer(flippers=None).without_rotors()
models = {
    "belt": c2d.BeltTrack(),
    "4 wheels": c2d.LineOfWheels(4, wheel_radius=0.0608),
    "5 wheels": c2d.LineOfWheels(5),
}
found = c2d.studies.max_obstacle(
    c2d.Scenario(robot, c2d.terrains.step(0.05)),
    models=models,
    heights=[0.03, 0.05, 0.07, 0.09, 0.11, 0.13],
    progress=False,
)
print(found[["highest", "limit"]].to_dataframe())
found.plot()
