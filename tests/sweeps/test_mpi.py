"""MPI: a job of several processes simulates for one store, as it would under Slurm."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.sweeps.stores import bits, hash_of

pytest.importorskip("mpi4py")

MPIEXEC = shutil.which("mpiexec", path=f"{Path(sys.executable).parent}{os.pathsep}{os.defpath}")
JOB = """
import sys
import crawler2d as c2d
from mpi4py.futures import MPIPoolExecutor

if __name__ == "__main__":
    base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05), duration=0.5)
    heights = {"terrain.height": [0.03, 0.06]}
    options = {"repeats": 40, "progress": False, "store": sys.argv[1]}
    if sys.argv[2:] == ["alone"]:
        c2d.sweep(base, heights, **options)
    else:
        with MPIPoolExecutor() as executor:
            c2d.sweep(base, heights, executor=executor, **options)
"""


@pytest.mark.skipif(MPIEXEC is None, reason="needs mpiexec")
def test_rows_of_an_mpi_job_are_those_of_one_process(tmp_path: Path) -> None:
    job, shared, alone = (tmp_path / name for name in ("job.py", "a.sqlite", "b.sqlite"))
    job.write_text(JOB)
    command = [str(MPIEXEC), "-n", "3", sys.executable, "-m", "mpi4py.futures", str(job)]
    subprocess.run([*command, str(shared)], check=True, timeout=100, cwd=tmp_path)
    subprocess.run([sys.executable, str(job), str(alone), "alone"], check=True, cwd=tmp_path)
    assert len(bits(shared)) == 80
    assert hash_of(shared) == hash_of(alone)
