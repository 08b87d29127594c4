"""
How hard is it held?
====================

`escape_force` measures the horizontal push at the centre of mass that moves a stopped robot on; a
branch of the run with that push shows how.
"""

import crawler2d as c2d

robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4)).without_rotors()
run = c2d.simulate(robot, c2d.terrains.step(0.10))
held, moved = run.escape_force()
print(f"{run.outcome}; held at {held:.0f} N, moved on by {moved:.0f} N")

pushed = run.branch(push=(moved, 1.0), duration=6.0)
axes = pushed.plot(time=[pushed.time[0], pushed.time[-1]])
axes.set_title(f"pushed with {moved:.0f} N: {pushed.outcome}", loc="left")
