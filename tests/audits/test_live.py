"""Output of an audit while it runs: finished parts, and on a terminal a count of runs."""

import io
import sys
from types import SimpleNamespace
from typing import Any

import pytest

from crawler2d.audits import runs
from crawler2d.audits.runs import LivePrinter, RunCounter, read_progress
from tests.audits.seizing import SAID
from tests.kept import refusing


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_runs_are_counted_below_the_parts_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    times = iter([100.0, 112.6])
    monkeypatch.setattr(runs, "time", SimpleNamespace(monotonic=lambda: next(times)))
    out = io.StringIO()
    printer = LivePrinter(out, str.upper)
    printer.print("a part")
    printer(3, 40)
    assert out.getvalue() == "A PART\n"
    clear = "\r\x1b[K"
    assert terminal.getvalue() == f"{clear}{clear}3 of at most 40 runs, 13 s\r"


def test_nothing_is_counted_where_nobody_looks(monkeypatch: pytest.MonkeyPatch) -> None:
    for other in (io.StringIO(), None):
        monkeypatch.setattr(sys, "stderr", other)
        out = io.StringIO()
        printer = LivePrinter(out)
        printer(3, 40)
        printer.print("a part")
        assert out.getvalue() == "a part\n"
        assert other is None or other.getvalue() == ""
    LivePrinter(None).print("a part")


class Full(io.StringIO):
    def write(self, _: str) -> int:
        raise OSError("no space left")


def test_a_full_disk_ends_an_audit_unless_it_keeps_progress_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with pytest.raises(OSError, match="no space"):
        LivePrinter(Full()).print("a part")
    full = Full()
    monkeypatch.setattr(sys, "stderr", full)
    LivePrinter(full).print("a part")


def test_runs_of_all_batches_are_counted_together() -> None:
    shown: list[tuple[int, int]] = []
    count = RunCounter(lambda done, total: shown.append((done, total)), 10)
    for batch in ((1, 4), (2, 3), (0, 9)):
        show = count.next_batch()
        assert show is not None
        for done in batch:
            show(done, 99)
    assert shown == [(1, 10), (4, 10), (6, 10), (7, 10), (7, 10), (16, 16)]
    silent = RunCounter(None, 1).next_batch()
    assert silent is not None
    silent(1, 1)


def test_progress_is_shown_in_one_of_four_ways(capsys: pytest.CaptureFixture[str]) -> None:
    show, count = read_progress(True)
    show("a part")
    assert capsys.readouterr().err == "a part\n"
    assert isinstance(count, LivePrinter)
    for none in (None, False):
        show, count = read_progress(none)
        show("a part")
        assert count is None
    calls: list[Any] = []
    show, count = read_progress(lambda *numbers: calls.append(numbers))
    show("a part")
    assert count is not None
    count(1, 2)
    assert calls == [(1, 2)]
    printer = LivePrinter(None)
    assert read_progress(printer) == (printer.print, printer)
    with refusing(SAID, "^progress must be True, False or a callable, got 3$"):
        read_progress(3)
    assert capsys.readouterr() == ("", "")
