"""Print the JSON Schema (draft 2020-12) of scenario files, for editors and checks.

It has the fields, types and ranges of this version of crawler2d. Rules that involve several fields
are only checked when a file is read.
"""

from __future__ import annotations

import argparse
import json

from crawler2d.parameters.schema import scenario_schema

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``crawler2d schema``: there are none."""
    del parser


def run(options: argparse.Namespace) -> int:
    """Print the schema; returns the exit status."""
    del options
    print(json.dumps(scenario_schema(), indent=2))
    return 0
