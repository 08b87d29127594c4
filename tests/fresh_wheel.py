"""What a user does with the wheel alone; `make test-wheel` runs it where there is no compiler."""

import shutil
import subprocess
import sys
from importlib.metadata import files
from pathlib import Path

import crawler2d as c2d

MODEL = Path(__file__).parent / "robots" / "absolem.sdf"


def main() -> None:
    """See the demonstration, and audit a public model, from the command line."""
    assert not any(shutil.which(name) for name in ("cargo", "rustc", "cc", "gcc"))
    assert Path(c2d.__file__).is_relative_to(sys.prefix), "not the wheel, but a working copy"
    assert {"LICENSE", "THIRD-PARTY-NOTICES"} <= {file.name for file in files("crawler2d") or ()}
    assert all(c2d.samples.path(name).is_file() for name in c2d.samples.names())
    program = [sys.executable, "-W", "ignore", "-m", "crawler2d"]
    subprocess.run([*program, "demo"], check=True)
    assert "seized" in Path("out/demo.html").read_text(encoding="utf-8")
    command = [*program, "audit", str(MODEL), "--quick"]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    print(done.stdout)
    assert done.returncode in (0, 1)  # whether it seizes in so few runs is not the question here
    assert "38.7 kg" in done.stdout
    assert "Verdicts" in done.stdout
    page = Path("out/audit-absolem.html").read_text(encoding="utf-8")
    assert page.startswith("<!doctype html>")


if __name__ == "__main__":
    main()
