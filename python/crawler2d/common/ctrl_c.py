"""Handle Ctrl-C of the command `crawler2d` while Python still imports the package."""

from __future__ import annotations

import os

__all__ = ["end_in_one_line", "is_command", "raise_again"]


def is_command(arguments: list[str], original: list[str]) -> bool:
    """Whether this process is the command, not a program that imports the package.

    Parameters
    ----------
    arguments, original : list of str
        `sys.argv`, which Python completes later for ``python -m``, and `sys.orig_argv`.

    Examples
    --------
    >>> is_command(["/usr/bin/crawler2d", "demo"], ["python", "/usr/bin/crawler2d", "demo"])
    True
    >>> is_command(["-m", "demo"], ["python", "-W", "ignore", "-m", "crawler2d", "demo"])
    True
    >>> is_command(["study.py"], ["python", "study.py"])
    False
    """
    program = arguments[0] if arguments else ""
    if program == "-m":
        return original[original.index("-m") + 1 :][:1] == ["crawler2d"]
    name = program.replace("\\", "/").rpartition("/")[2]
    return name.removesuffix(".exe") == "crawler2d"


def end_in_one_line() -> None:
    """Let Ctrl-C end the process with one line and the usual status, until `raise_again`.

    For an exception Python would print a traceback, or lose it within some imports.
    """
    import signal  # noqa: PLC0415 - which only the command needs

    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # else Ctrl-C is ignored
        signal.signal(signal.SIGINT, _end)


def raise_again() -> None:
    """Let Ctrl-C raise KeyboardInterrupt, as usual."""
    import signal  # noqa: PLC0415

    if signal.getsignal(signal.SIGINT) is _end:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def _end(number: int, _: object) -> None:
    # A terminal shows ^C at the beginning of the line.
    begin = "\n" if os.isatty(2) else ""
    os.write(2, f"{begin}crawler2d: interrupted\n".encode())
    os._exit(128 + number)  # there is nothing to clean up yet
