"""Colours that the colour-blind can tell apart: those of Okabe and Ito, and what goes with them."""

__all__ = ["BLACK", "BLUE", "GRAY", "GREEN", "GROUND", "ORANGE", "PURPLE", "RED", "SKY", "VIOLET"]

BLACK, ORANGE, SKY, GREEN = "#222222", "#E69F00", "#56B4E9", "#009E73"
BLUE, RED, PURPLE = "#0072B2", "#D55E00", "#CC79A7"
# Dark enough for a thin line on what is filled with it.
VIOLET = "#A3327B"
GRAY, GROUND = "#AAAAAA", "#D9D2C5"
