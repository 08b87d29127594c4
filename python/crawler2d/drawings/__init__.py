"""Robot and ground as outlines: in figures, as SVG and in notebooks; from plain data alone."""
