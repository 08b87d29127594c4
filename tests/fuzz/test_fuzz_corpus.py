"""The cases that fuzzing by coverage has kept: each is read, or refused as is documented."""

import sys
import time
from pathlib import Path

import pytest

from tests.fuzz.guided_targets import TARGETS, prepare

CASES = Path(__file__).parent / "corpus"
LONGEST = 10.0  # [s] of the clock for one


@pytest.mark.skipif(sys.platform == "win32", reason="has limits of Unix")
@pytest.mark.filterwarnings("ignore::crawler2d.ScenarioWarning")
@pytest.mark.parametrize("name", TARGETS)
def test_every_kept_case_is_read_or_refused(name: str, tmp_path: Path) -> None:
    if name in ("xacro", "mjcf"):
        pytest.importorskip({"xacro": "xacrodoc", "mjcf": "mujoco"}[name])
    prepare(name, tmp_path)
    cases = sorted((CASES / name).iterdir())
    assert len(cases) > 10
    for case in cases:
        begin = time.monotonic()
        TARGETS[name](case.read_bytes(), tmp_path)
        assert time.monotonic() - begin < LONGEST, case.name
