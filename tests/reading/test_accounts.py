"""What is read of files with a bit of everything, all of it, line by line: as kept in `accounts`.

With CRAWLER2D_KEEP_ACCOUNTS=1 in the environment the accounts are written anew. Each difference
from what was kept is a fault, or is meant.
"""

import os
from pathlib import Path
from typing import Any

import pytest

from tests.reading.carts import WHEELS, pair, quietly, urdf
from tests.reading.telling import account
from tests.reading.test_gear_wheels import gear
from tests.reading.test_surfaces import arms, drums

KEPT = Path(__file__).parent / "accounts"

GENERATED = {
    "gears.urdf": urdf(*(gear(f"w{n}", 0.1 * n * n, turn=0.3 * n) for n in (1, 2, 3))),
    "drums.urdf": urdf(
        pair("front", 0.2), drums("rear", -0.2, 0.06), arms(0.2, 0.25), arms(-0.2, -0.25)
    ),
    "bare.urdf": urdf(WHEELS).replace('<limit effort="5" velocity="10"/>', ""),
}
"""Gear wheels that stand unevenly, a sprocket with fixed drums, and wheels without limits."""


def told(folder: Path, name: str, **how: Any) -> list[str]:
    """Return the lines of the account of a file that is kept or generated."""
    path = KEPT / name
    if name in GENERATED:
        path = folder / name
        path.write_text(GENERATED[name], encoding="utf-8")
    elif path.suffix == ".xml":
        pytest.importorskip("mujoco")
    return account(quietly(path, **how)).splitlines()


def compare(lines: list[str], name: str) -> None:
    kept = KEPT / f"{name}.txt"
    if os.environ.get("CRAWLER2D_KEEP_ACCOUNTS"):
        kept.write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")
    assert lines == kept.read_text(encoding="utf-8").splitlines()


@pytest.mark.parametrize("name", ["odd.urdf", "odd.sdf", "odd.xml", *GENERATED])
def test_a_file_is_read_as_its_account_says(tmp_path: Path, name: str) -> None:
    compare(told(tmp_path, name), name)


@pytest.mark.parametrize(
    ("name", "how"),
    [
        *(("odd.urdf", {"engine": each}) for each in ("classic", "bullet", "mujoco", "isaac")),
        ("odd.urdf", {"forward": "-y"}),
        ("odd.urdf", {"ground_friction": 0.5}),
        ("odd.sdf", {"mesh": "leave_out"}),
        ("odd.sdf", {"scale": 0.5}),
        ("odd.xml", {"engine": "gz"}),
    ],
    ids=lambda value: value if isinstance(value, str) else "-".join(map(str, *value.items())),
)
def test_a_keyword_changes_these_lines_of_an_account(
    tmp_path: Path, name: str, how: dict[str, Any]
) -> None:
    usual = told(tmp_path, name)
    changed = [line for line in told(tmp_path, name, **how) if line not in usual]
    compare(changed, f"{name}.{'-'.join(map(str, *how.items()))}")
