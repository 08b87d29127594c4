"""Xacro as URDF text: expanded in a child process, because its expressions may do much work."""

from __future__ import annotations

from collections.abc import Mapping

from crawler2d.reading.child import answered
from crawler2d.reading.elements import Element
from crawler2d.reading.files import Files
from crawler2d.reading.telling import Doubt

__all__ = ["expanded"]


def expanded(
    files: Files,
    data: bytes,
    root: Element,
    *,
    trusted: bool,
    arguments: Mapping[str, str],
    leave_out: bool,
) -> tuple[bytes, list[Doubt]]:
    """Expand a file.

    Parameters
    ----------
    files : Files
        Those of the model.
    data : bytes
        What it holds.
    root : Element
        Of the file, for errors.
    trusted : bool
        Whether its user trusts it: Python evaluates its expressions, whatever they are.
    arguments : mapping of str to str
        Values of its ``xacro:arg``.
    leave_out : bool
        Whether it does without what is not there: includes and calls of their macros are left out,
        arguments without a value are looked for in settings.

    Returns
    -------
    text : bytes
        The URDF.
    doubts : list of Doubt
        What was left out, and what was taken for something that is not there.

    Raises
    ------
    ScenarioError
        If it does not expand, needs what is not there, or is not trusted and has expressions of
        more than plain data and known functions.
    ImportError
        If xacrodoc is missing; the message names the extra to install.
    """
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        root.refuse("another encoding", "must be UTF-8, which xacro reads")
    question = {
        "text": text,
        "file": root.where.file,
        "files": files.plain,
        "trusted": trusted,
        "arguments": {name: str(value) for name, value in arguments.items()},
        "leave_out": leave_out,
    }
    answer = answered(
        "crawler2d.reading.xacro_child", question, file=root.where.file, folder=files.folder
    )
    return answer["text"].encode(), [(path, value, why) for path, value, why in answer["doubts"]]
