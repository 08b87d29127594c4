"""Stored results of benches/: contents of tables, and continuation of runs."""

import lzma
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from benches.shared import results
from benches.shared.results import CHECKSUMS, Results, checksums, read, read_text, write_text

WRITTEN = "python -m benches.shared.results writes the list again"


def test_every_stored_file_has_its_checksum() -> None:
    assert CHECKSUMS.read_text(encoding="utf-8") == checksums(), WRITTEN
    assert "models/predictions.json.xz" in checksums()


def test_text_is_read_as_it_was_written_and_equal_text_gives_equal_files(tmp_path: Path) -> None:
    one, other = tmp_path / "one.json.xz", tmp_path / "folder" / "other.json.xz"
    for path in (one, other):
        write_text(path, '{"µ": 0.1}\n')
    assert read_text(one) == '{"µ": 0.1}\n'
    assert one.read_bytes() == other.read_bytes()
    assert lzma.decompress(one.read_bytes()).decode("utf-8") == read_text(one)
    assert read(one) == {"µ": 0.1}
    assert read(tmp_path / "none.json.xz", missing=[]) == []


def test_results_continue_where_they_were_interrupted(tmp_path: Path) -> None:
    def run(job: int) -> int:
        if job == 2:
            raise KeyboardInterrupt
        return 10 * job

    path = tmp_path / "results.json.xz"
    with pytest.raises(KeyboardInterrupt):
        Results(path).add(((("a", "b"), job) for job in range(4)), run)
    assert read(path) == {"a": {"b": [0, 10]}}
    again = Results(path)
    with ThreadPoolExecutor(2) as executor:
        again.add([(("a", "b"), 7), (("c",), 8)], str, executor)
    assert read(path) == again.data == {"a": {"b": [0, 10, "7"]}, "c": ["8"]}


def test_long_runs_are_written_on_their_way(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(results, "_INTERVAL", 0.0)
    path = tmp_path / "results.json.xz"
    seen: list[object] = []

    def run(job: int) -> int:
        seen.append(read(path))
        return job

    Results(path).add(((("a",), job) for job in range(3)), run)
    assert seen == [None, {"a": [0]}, {"a": [0, 1]}]
