"""Changes of an audited file, on audits with made-up runs."""

from dataclasses import replace
from pathlib import Path

import pytest

import crawler2d as c2d
from crawler2d.audits import repairs
from crawler2d.audits.patches import _on_belts, best_change, change_of, diffs_of
from crawler2d.audits.record import AuditRecord
from crawler2d.audits.runs import belt_of
from tests.audits.made import made_of_file, made_of_robot
from tests.audits.seizing import SEIZING
from tests.kept import check_kept
from tests.patching.test_kept_patches import NUMBER, rounded
from tests.reading.carts import FILES, quietly

KEPT = Path(__file__).parent / "kept"


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> AuditRecord:
    return made_of_file(tmp_path_factory.mktemp("made"))


def test_every_change_of_a_file_is_as_kept(made: AuditRecord) -> None:
    lines: list[str] = []
    for repair in made.repairs:
        change = change_of(made, repair)
        lines += [repair.description, change.label, change.summary, change.suffix, *change.left]
        lines += [change.diff if repair.kind != "belt" else change.text]
    check_kept(KEPT / "changes.diff", NUMBER.sub(rounded, "\n".join(lines)))


def test_wheels_and_gears_have_their_difference_on_the_page(made: AuditRecord) -> None:
    wheels, gears, _ = made.repairs
    found = diffs_of(made)
    assert list(found) == [wheels.description, gears.description]
    change = change_of(made, wheels)
    assert found[wheels.description] == f"{change.summary}\n\n{change.diff}"
    same = replace(wheels, robot=made.robot)
    assert made.repaired is not None
    unchanged = replace(made, repaired=made.repaired._replace(repairs=(same,)))
    (text,) = diffs_of(unchanged).values()
    assert text.startswith("no change of the file: robot.track must have wheels that")
    assert diffs_of(made_of_robot()) == {}


@pytest.mark.parametrize(
    ("name", "summary", "suffix", "head"),
    [
        ("cart.sdf", "a new SDF file", "", "<sdf "),
        ("cart.xml", "a new MJCF file", "", "<mujoco "),
        ("cart.urdf", "a new SDF file, because URDF holds no belts", ".sdf", "<sdf "),
    ],
)
def test_belts_are_a_new_file_of_the_format_or_of_sdf(
    made: AuditRecord, name: str, summary: str, suffix: str, head: str
) -> None:
    if name.endswith(".xml"):
        pytest.importorskip("mujoco")
    audit = replace(made, reading=quietly(FILES / name))
    change = _on_belts(audit, belt_of(SEIZING).robot, None)
    assert (change.summary, change.suffix) == (summary, suffix)
    assert head in change.text
    assert change.label == (
        "not confirmed: belts moved by a track plugin (BeltTrack, along the outline); the belt"
        " cleared 75 % or more where the file seized"
    )
    assert f"crawler2d, {change.label}" in " ".join(change.text.split())


def test_the_best_change_is_a_confirmed_one_or_else_what_seizes_less(made: AuditRecord) -> None:
    wheels, gears, belts = made.repairs
    named = {each.obstacle: each for each in made.verdicts}

    def best(*some: repairs.Repair) -> str:
        assert made.repaired is not None
        found = best_change(replace(made, repaired=made.repaired._replace(repairs=some)))
        return "" if found is None else found.label

    assert best(gears, wheels, belts).startswith("confirmed: chassis: 5 wheels")
    assert best(gears, belts).startswith("not confirmed: chassis: gear wheels")
    often = replace(gears, seized={name: each.seized for name, each in named.items()})
    assert best(often, belts).startswith("confirmed: belts")  # as often as the file
    assert best(often).startswith("not confirmed: belts moved by a track plugin")
    nowhere = replace(made, verdicts=made.verdicts[3:4])
    assert best_change(nowhere) is None


@pytest.mark.parametrize(
    ("carrier", "wanted"),
    [("chassis", {"chassis"}), ("front flipper", {"flippers"}), ("rear flipper", {"flippers"})],
)
def test_the_wheels_that_seize_are_those_that_are_changed(
    made: AuditRecord, monkeypatch: pytest.MonkeyPatch, carrier: str, wanted: set[str]
) -> None:
    asked = []

    class AskedError(Exception):
        pass

    def candidates(robot: c2d.Robot, carriers: set[str]) -> None:
        asked.append((robot, carriers))
        raise AskedError

    monkeypatch.setattr(repairs, "candidates_of", candidates)
    clears = made.verdicts[3]
    with pytest.raises(AskedError):
        repairs.search_repairs(
            made.robot,
            made.belt,
            grounds=made.obstacles,
            verdicts=[replace(clears, carrier="belly"), replace(made.verdicts[0], carrier=carrier)],
            table=made.table,
            runs=None,  # type: ignore[arg-type]
            is_quick=True,
            show=None,
        )
    assert asked == [(made.robot, wanted)]
