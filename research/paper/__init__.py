"""The paper that introduced gear wheels, reproduced: `python -m research paper`."""
