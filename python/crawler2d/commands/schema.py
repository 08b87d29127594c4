"""Print the JSON Schema (draft 2020-12) of scenario files, for editors and checks.

It contains the fields, types and ranges of this version of crawler2d. Rules about several fields
are only checked when a file is read.
"""

from __future__ import annotations

import argparse
import json

from crawler2d.parameters.schema import scenario_schema

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add no options."""
    del parser


def run(options: argparse.Namespace) -> int:
    """Print the schema; return the exit status."""
    del options
    print(json.dumps(scenario_schema(), indent=2))
    return 0
