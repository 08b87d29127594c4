"""The stored cases of fuzzing by coverage: each is read, or refused as documented."""

import sys
import time
from pathlib import Path

import pytest

from tests.fuzz.guided import widest
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


def test_the_kept_corpus_reaches_most_edges() -> None:
    """A small case with little coverage is not preferred to one with more."""
    cases = {"a": "1", "b": "2", "c": "1 2 3", "d": "4 5 6 7", "e": "7 8"}
    lines = [f"STARTED {n} {n}\nFT {n} {edges}\nCOV {n}" for n, edges in enumerate(cases.values())]
    control = "\n".join(["5", "0", *cases, *lines])
    assert widest(control, 2) == ["d", "c"]
    assert widest(control, 40) == ["d", "c", "e"]
