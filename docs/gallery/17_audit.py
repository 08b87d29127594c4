"""
Audit a model file
==================

`audit` reads a model, drives it over an obstacle with its uncertain parameters resampled, compares
it with belts, and looks for the smallest change that prevents a seizure. The file is a small robot
that crawler2d brings along.
"""

import crawler2d as c2d

file = c2d.samples.path("rover.sdf")
print(c2d.read_robot(file).description)

step = {"step": c2d.terrains.step(0.05, friction=0.6)}
audit = c2d.audit(file, step, quick=True, progress=False)
for verdict in audit.verdicts:
    print(verdict.result, "between wheels", verdict.jam_wheels)
for repair in audit.repairs:
    print(repair.description, "- confirmed" if repair.confirmed else "- not confirmed")

# %%
# The robot as it was read, before that step:

c2d.Scenario(audit.robot, step["step"]).plot()
