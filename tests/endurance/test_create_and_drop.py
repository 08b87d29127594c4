"""Objects created and dropped repeatedly leave no memory, descriptors or threads behind."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from crawler2d.sweeps.store import Store
from tests.endurance.resources import check_flat, held
from tests.shared import ROBOT, VARIANTS
from tests.sweeps.small import BRIEF, quiet

Say = Callable[[str], None]

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="memory is read from /proc")

BELT, CHAIN = VARIANTS["belt-step"], VARIANTS["segmental-step"]
WITH_HISTORY = c2d.simulate(ROBOT, c2d.terrains.flat(), duration=0.2)


def simulation(_: int, __: Path) -> None:
    sim = c2d.Simulation(CHAIN)
    sim.advance(0.002)
    sim.state()


def copied_simulation(_: int, __: Path) -> None:
    sim = c2d.Simulation(BELT)
    sim.advance(0.01)
    c2d.Simulation.from_snapshot(sim.snapshot()).advance(0.01)


def batch(_: int, __: Path) -> None:
    many = c2d.Simulations([BELT] * 3, threads=2)
    many.advance(0.01)
    many.state()


def run(_: int, __: Path) -> None:
    c2d.simulate(BRIEF, sample_interval=0.01)


def runs(_: int, __: Path) -> None:
    c2d.simulate_many([BRIEF] * 3, threads=2)


def page(_: int, folder: Path) -> None:
    WITH_HISTORY.to_html(folder / "page.html")


def saved(_: int, folder: Path) -> None:
    c2d.load(WITH_HISTORY.save(folder / "run.npz"))


def store(_: int, folder: Path) -> None:
    with Store(folder / "store.sqlite") as kept:
        kept.read(["none"])
    c2d.check_store(folder / "store.sqlite")


def sweep(number: int, folder: Path) -> None:
    path = folder / "sweep.sqlite"
    path.unlink(missing_ok=True)  # more and more rows would need more and more memory
    quiet(BRIEF, {}, repeats=1, seed=number, store=path)


def scenario(number: int, _: Path) -> None:
    fields = {"terrain.height": 0.02 + 1e-3 * (number % 100)}
    c2d.Scenario.from_json(BELT.replace(fields).to_json()).validate()


def refused(_: int, __: Path) -> None:
    with pytest.raises(c2d.ScenarioError):
        Scenario(ROBOT, c2d.terrains.step(-0.1)).validate()


KINDS = {
    each.__name__: each
    for each in (
        *(simulation, copied_simulation, batch, run, runs, page, saved, store, sweep),
        *(scenario, refused),
    )
}


def check(kind: str, cycles: int, megabytes: float, folder: Path, say: Say) -> None:
    """Check the growth of memory: 2 MB in ten thousand cycles are two hundred bytes in each."""
    once = KINDS[kind]
    for number in range(max(10, cycles // 10)):  # one-time allocations and fragmentation
        once(number, folder)
    before = held()
    for number in range(cycles):
        once(number, folder)
    say(f"{cycles} x {kind}: {check_flat(before, held(), megabytes)}")


@pytest.mark.parametrize("kind", KINDS)
def test_a_few_dozen_of_a_kind_leave_nothing_behind(kind: str, tmp_path: Path, say: Say) -> None:
    check(kind, 10 if kind == "sweep" else 40, 2.0, tmp_path, say)


@pytest.mark.soak
@pytest.mark.parametrize("kind", KINDS)
def test_ten_thousand_of_a_kind_leave_nothing_behind(kind: str, tmp_path: Path, say: Say) -> None:
    check(kind, 10_000, 2.0, tmp_path, say)
