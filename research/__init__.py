"""The project's own studies, and the paper that introduced gear wheels, reproduced.

Programs of `python -m research`, in a clone of the project. Their robots are presets without
rotors, as models for simulators are, but in the study of drives: all published figures are of such
robots.
"""
