"""The project's own studies, and the paper that introduced gear wheels, reproduced.

Programs of `python -m research`, in a clone of the project. Except in the study of drives, robots
are presets without rotors, like models for simulators, on which all published figures are based.
"""
