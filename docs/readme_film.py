"""Writes docs/readme-light.gif and readme-dark.gif, the example of README.md, for `make film`."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from PIL import Image, ImageSequence

import crawler2d as c2d

LIGHT = Path(__file__).with_name("readme-light.gif")
DARK = LIGHT.with_name("readme-dark.gif")


def film() -> None:
    """Show the robot of the example on wheels and on a belt."""
    robot = c2d.robots.engineer(flippers=None).without_rotors()
    wheels = robot.with_track(c2d.LineOfWheels(4, wheel_radius=0.0608))
    runs = [c2d.simulate(each, c2d.terrains.step(0.075)) for each in (wheels, robot)]
    c2d.animate(runs, LIGHT, labels=["on wheels", "on a belt"], fps=12.5, width=640)


def darken() -> None:
    """Write the same film with light lines on black, in colours of the same hue."""
    with Image.open(LIGHT) as light:
        frames = [_inverted(frame) for frame in ImageSequence.Iterator(light)]
        times = [frame.info["duration"] for frame in ImageSequence.Iterator(light)]
    frames[0].save(DARK, save_all=True, append_images=frames[1:], duration=times, loop=0)


def _inverted(frame: Image.Image) -> Image.Image:
    pixels = 255 - np.asarray(frame.convert("RGB"))
    hue, *rest = Image.fromarray(pixels).convert("HSV").split()
    turned = Image.fromarray(np.asarray(hue) + np.uint8(128))
    return Image.merge("HSV", (turned, *rest)).convert("RGB").quantize(64, dither=Image.Dither.NONE)


if __name__ == "__main__":
    mpl.use("Agg")
    film()
    darken()
