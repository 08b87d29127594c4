"""The paper that introduced gear wheels, reproduced: `python -m crawler2d paper`."""
