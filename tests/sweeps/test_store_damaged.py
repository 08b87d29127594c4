"""A damaged store is refused, or read as it was written."""

import random
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d.sweeps import database
from crawler2d.sweeps.store import Store
from tests.sweeps.small import BASE, quiet
from tests.sweeps.stores import TRIALS, as_version_1, change, opened, read, sound, told

PAGE = 4096
COLUMNS = (
    *("identity", "build", "trials", "outcome", "metrics"),
    *("diagnosis", "wall_time", "error", "scenario", "checksum"),
)


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return sound(tmp_path_factory.mktemp("store") / "a.sqlite")


@pytest.fixture
def path(store: Path, tmp_path: Path) -> Path:
    """A copy of it."""
    path = tmp_path / "a.sqlite"
    path.write_bytes(store.read_bytes())
    return path


def flip(path: Path, draw: random.Random, count: int = 1) -> None:
    content = bytearray(path.read_bytes())
    for _ in range(count):
        content[draw.randrange(len(content))] ^= draw.randrange(1, 256)
    path.write_bytes(content)


def flip_the_structure(path: Path, draw: random.Random) -> None:
    """Change a byte in the description of a page."""
    content = bytearray(path.read_bytes())
    start = PAGE * draw.randrange(len(content) // PAGE)
    content[start + draw.randrange(100 if start == 0 else 24)] ^= draw.randrange(1, 256)
    path.write_bytes(content)


def flip_many(path: Path, draw: random.Random) -> None:
    flip(path, draw, 20)


def cut(path: Path, draw: random.Random) -> None:
    """Cut it to a part; an empty file would be a new store."""
    content = path.read_bytes()
    path.write_bytes(content[: draw.randrange(1, len(content))])


def cut_pages(path: Path, draw: random.Random) -> None:
    content = path.read_bytes()
    path.write_bytes(content[: PAGE * draw.randrange(1, len(content) // PAGE)])


def zero_a_page(path: Path, draw: random.Random) -> None:
    content = bytearray(path.read_bytes())
    start = PAGE * draw.randrange(len(content) // PAGE)
    content[start : start + PAGE] = bytes(PAGE)
    path.write_bytes(content)


def copy_a_page(path: Path, draw: random.Random) -> None:
    content = bytearray(path.read_bytes())
    one, other = (PAGE * k for k in draw.sample(range(len(content) // PAGE), 2))
    content[one : one + PAGE] = content[other : other + PAGE]
    path.write_bytes(content)


def swap_columns(path: Path, draw: random.Random) -> None:
    """Swap some columns of two rows."""
    with opened(path) as connection:
        (count,) = connection.execute("SELECT count(*) FROM run").fetchone()
        rows = draw.sample(range(1, count + 1), 2)
        names = draw.sample([*COLUMNS[3:8], COLUMNS[9]], draw.randrange(1, 6))
        query = f"SELECT {', '.join(names)} FROM run WHERE rowid = ?"
        one, other = (connection.execute(query, (row,)).fetchone() for row in rows)
        change = f"UPDATE run SET {' = ?, '.join(names)} = ? WHERE rowid = ?"
        connection.execute(change, (*other, rows[0]))
        connection.execute(change, (*one, rows[1]))


DAMAGES: list[Callable[[Path, random.Random], None]] = [
    flip,
    flip_the_structure,
    flip_many,
    cut,
    cut_pages,
    zero_a_page,
    copy_a_page,
    swap_columns,
]


@pytest.mark.parametrize("repeats", [8, pytest.param(2500, marks=pytest.mark.soak)])
@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_store_is_refused_or_read_as_it_was(
    store: Path,
    tmp_path: Path,
    damage: Callable[[Path, random.Random], None],
    repeats: int,
) -> None:
    whole, count = read(store), Counter[str]()
    draw = random.Random(damage.__name__)
    for number in range(repeats):
        path = tmp_path / f"{number}.sqlite"
        path.write_bytes(store.read_bytes())
        damage(path, draw)
        damaged = path.read_bytes()
        findings: Any
        try:
            findings = c2d.check_store(path)
        except c2d.StoreError as error:
            findings = error
        is_refused = False
        for way in (read, found_in, joined):
            path.write_bytes(damaged)
            try:
                assert way(path) == whole
            except c2d.StoreError as error:
                # One byte of the header only prevents SQLite from writing: all can be read.
                is_refused |= "attempt to write a readonly database" not in str(error)
        assert is_refused == (findings != ())
        count["refused" if is_refused else "harmless"] += 1
        path.unlink()
    print(f"{damage.__name__}: {dict(count)}")
    assert count["refused"] > 0


def found_in(path: Path) -> dict[str, str]:
    with Store(path, TRIALS) as store:
        build = c2d.build_info()["build_id"]
        names = [name for (name,) in store._connection.execute("SELECT identity FROM run")]
        return {key: told(row, build, TRIALS) for key, row in store.read(names).items()}


def joined(path: Path) -> dict[str, str]:
    other = path.with_suffix(".joined")
    try:
        c2d.join_stores(other, path)
        return read(other)
    finally:
        other.unlink(missing_ok=True)


@pytest.mark.parametrize("column", COLUMNS)
@pytest.mark.parametrize("value", ["'x'", "''", "x'ff'", "CAST(x'80' AS TEXT)", "1e300"])
def test_a_changed_column_is_reported_with_its_row(path: Path, column: str, value: str) -> None:
    with opened(path) as connection:
        connection.execute(f"UPDATE run SET {column} = {value} WHERE rowid = 3")
    with pytest.raises(c2d.StoreError, match=r"row 3 \(run .*\) is damaged: its") as caught:
        c2d.table(path)
    assert str(caught.value).isascii()  # characters that any terminal prints
    (damage,) = c2d.check_store(path)
    assert (damage.row, damage.message) == (3, "its checksum is another")


@pytest.mark.parametrize(
    ("columns", "what"),
    [
        ({"scenario": "{}"}, "its scenario does not hash to its identity"),
        ({"outcome": "flown"}, "'flown' is not an outcome without an error"),
        ({"outcome": "diverged"}, "'diverged' is not an outcome without an error"),
        ({"error": '["SimulationDiverged", "?"]'}, "not an outcome with an error"),
        ({"metrics": "[1]"}, "AttributeError"),
        ({"metrics": '{"time": "long"}'}, "'long' is not a number"),
        ({"metrics": "[" * 100_000}, "RecursionError"),
        ({"metrics": "?"}, "JSONDecodeError"),
        ({"trials": "7"}, "TypeError"),
        ({"diagnosis": "{}"}, "KeyError"),
        ({"outcome": "diverged", "error": '["raise_first", []]'}, "KeyError: 'raise_first'"),
        ({"outcome": "diverged", "error": '["Crawler2dError", "?"]'}, "KeyError"),
        ({"outcome": "diverged", "error": '["SimulationDiverged"]'}, "TypeError"),
        ({"outcome": "diverged", "error": "[]"}, "TypeError"),
    ],
)
def test_a_row_that_holds_no_run_is_refused_although_its_checksum_is_right(
    path: Path, columns: dict[str, str], what: str
) -> None:
    change(path, 3, **columns)
    with pytest.raises(c2d.StoreError, match=r"row 3 \(run .*\) is damaged") as caught:
        c2d.table(path)
    assert what in str(caught.value)
    (damage,) = c2d.check_store(path)
    assert damage.row == 3
    assert what in damage.message


def test_all_damage_is_listed(path: Path) -> None:
    with opened(path) as connection:
        connection.execute("UPDATE run SET wall_time = 0.5 WHERE rowid IN (8, 2)")
        connection.execute("CREATE INDEX mine ON run (build)")
        connection.execute("PRAGMA writable_schema = ON")
        connection.execute("UPDATE sqlite_master SET rootpage = 2 WHERE name = 'mine'")
    found = c2d.check_store(path)
    assert [damage.row for damage in found if damage.row is not None] == [2, 8]
    assert any(damage.row is None for damage in found)
    with pytest.raises(c2d.StoreError, match="check_store lists"):
        c2d.table(path)


def test_a_store_of_the_former_format_is_converted_and_nothing_runs_again(
    store: Path, path: Path
) -> None:
    as_version_1(path)
    for read_only in (c2d.table, c2d.check_store, lambda path: c2d.join_stores("none", path)):
        with pytest.raises(c2d.StoreError, match="converts it"):
            read_only(path)
    assert c2d.join_stores(path) == 0
    assert read(path) == read(store)
    assert c2d.check_store(path) == ()
    assert c2d.join_stores(path, store) == 0


@pytest.mark.parametrize(
    "columns", [{"outcome": "flown"}, {"scenario": "{}"}, {"diagnosis": '{"contacts": {}}'}]
)
def test_a_damaged_store_of_the_former_format_is_refused_and_left_alone(
    path: Path, columns: dict[str, str]
) -> None:
    change(path, 3, **columns)
    as_version_1(path)
    for _ in range(2):
        with pytest.raises(c2d.StoreError, match="is damaged: "):
            c2d.join_stores(path)
    with opened(path) as connection:
        assert connection.execute("PRAGMA user_version").fetchone() == (1,)
        assert connection.execute("SELECT count(*) FROM run").fetchone() == (21,)


@pytest.mark.parametrize(
    ("version", "message"),
    [
        (3, r"by a newer crawler2d \(version 3 of the format; this one reads 2\): upgrade"),
        (99, "newer crawler2d"),
        (0, "is damaged"),
        (-1, "is damaged"),
    ],
)
def test_a_store_of_another_format_is_refused(path: Path, version: int, message: str) -> None:
    with opened(path) as connection:
        connection.execute(f"PRAGMA user_version = {version}")
    before = path.read_bytes()
    for use in (c2d.table, c2d.check_store, c2d.join_stores):
        with pytest.raises(c2d.StoreError, match=message):
            use(path)
    assert path.read_bytes() == before


def test_a_store_of_the_former_format_that_was_killed_can_be_opened(tmp_path: Path) -> None:
    path = tmp_path / "a.sqlite"
    with opened(path) as connection:
        connection.execute("PRAGMA journal_mode = WAL")
        connection.execute(f"PRAGMA application_id = {database._APPLICATION}")
        connection.execute("PRAGMA user_version = 1")
    with pytest.raises(c2d.StoreError, match="is empty"):
        c2d.table(path)
    quiet(BASE, {}, repeats=2, store=path)
    assert len(read(path)) == 2


def test_a_store_whose_list_of_tables_is_lost_is_no_new_one(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[103:105] = bytes(2)  # the number of tables and indices on the first page
    path.write_bytes(content)
    for use in (c2d.table, c2d.check_store, c2d.join_stores):
        with pytest.raises(c2d.StoreError, match="is damaged: no crawler2d makes such tables"):
            use(path)
    assert path.read_bytes() == content


def test_a_store_cut_to_one_byte_is_no_new_one(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:1])
    for use in (c2d.table, c2d.check_store, c2d.join_stores, found_in):
        with pytest.raises(c2d.StoreError, match="is damaged"):
            use(path)
    assert path.stat().st_size == 1


def test_damage_that_breaks_sqlites_own_check_is_reported(path: Path) -> None:
    content = path.read_bytes()
    assert content.count(b"CREATE TABLE run") == 1
    # The name and the statement of a table.
    path.write_bytes(content.replace(b"runrun\x02CREATE TABLE", b"\x9funrun\x02CRXATE TABLE"))
    assert path.read_bytes() != content
    for use in (c2d.table, c2d.check_store, c2d.join_stores):
        with pytest.raises(c2d.StoreError, match="is damaged"):
            use(path)


def test_custom_tables_and_indices_are_kept(path: Path) -> None:
    whole = read(path)
    with opened(path) as connection:
        connection.execute("CREATE INDEX by_outcome ON run (outcome)")
        connection.execute("CREATE TABLE notes (text)")
        connection.execute("ANALYZE")
    assert read(path) == found_in(path) == whole
    assert c2d.check_store(path) == ()
