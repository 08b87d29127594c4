"""
Write a model and a world
=========================

A robot on wheels or smooth belts becomes a model in three dimensions, for Gazebo or MuJoCo, by
itself or before an obstacle. It can be read back, but for what the format has no place for, such as
rotors in SDF.
"""

import tempfile
from pathlib import Path

import crawler2d as c2d

robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(5))
with tempfile.TemporaryDirectory() as folder:
    robot.to_world(Path(folder, "world.sdf"), c2d.terrains.step(0.075))
    robot.to_mjcf(Path(folder, "robot.xml"))
    print(*Path(folder, "robot.xml").read_text().splitlines()[10:20], sep="\n")
    again = c2d.read_robot(Path(folder, "world.sdf"))
print(again.description)
again.robot.plot()
