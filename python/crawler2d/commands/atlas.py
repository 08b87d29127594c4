"""Audit every model file in a folder of repositories, and write one page.

The page is rewritten after each robot, so Ctrl-C keeps finished audits.
"""

from __future__ import annotations

import argparse
import os
import re
import warnings
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from crawler2d.audits import words
from crawler2d.audits.audit import Audit, audit
from crawler2d.audits.page.drawings import draw_robot
from crawler2d.commands.files import OUT, check_place
from crawler2d.common.arrays import whole_number
from crawler2d.common.files import write_text
from crawler2d.drawings.svg import escape
from crawler2d.errors import Crawler2dError, ScenarioError, ScenarioWarning
from crawler2d.pictures.page import fill_page, read_part
from crawler2d.reading.reading import Reading, read_robot
from crawler2d.runs.progress import thread_count

__all__ = ["Entry", "add_arguments", "main_files", "run"]

_PAGE = OUT / "atlas.html"
_HERE = "crawler2d.commands"
_SAMPLES = 40

_KINDS = (".sdf", ".world", ".urdf", ".xacro", ".xml", ".mjcf")
_ANYTHING = (".xml", ".xacro")  # may hold something else
_LARGEST = 4_000_000  # [bytes] as for any model file
_MOST = 5000  # model files, all kept in memory
_ROOTS = re.compile(rb"<\s*(sdf|robot|mujoco)[\s>]")
_NAMED = re.compile(rb"""(?:filename|file)\s*=\s*["']([^"']+\.(?:xacro|urdf|xml|sdf))["']""")
_MACROS = re.compile(rb"<xacro:macro\b.*?</xacro:macro>|<!--.*?-->", re.DOTALL)
_LINKS = re.compile(rb"<(?:link|worldbody|model|xacro:(?!property|arg|macro)\w+)\b")


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """A model file with its results, or the reason why it was not read.

    Parameters
    ----------
    path : Path
        Path relative to the folder of the atlas.
    reading : Reading, optional
        Reading of the file.
    audit : Audit, optional
        Audit of the robot.
    refusal : str
        Why the file was not read or not audited; "" if it was.
    """

    path: Path
    reading: Reading | None = None
    audit: Audit | None = None
    refusal: str = ""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument("folder", type=Path, help="a folder of repositories")
    parser.add_argument(
        "--html", type=Path, default=_PAGE, metavar="PAGE", help=f"page to write (default: {_PAGE})"
    )
    samples = f"samples of the uncertain parameters of each robot (default: {_SAMPLES})"
    parser.add_argument("--samples", type=int, metavar="N", default=_SAMPLES, help=samples)
    parser.add_argument(
        "--threads", type=int, metavar="N", help="number of threads (default: all cores)"
    )


def run(options: argparse.Namespace) -> int:
    """Write the atlas of a folder; return the exit status."""
    folder: Path = options.folder
    if not folder.is_dir():
        raise ScenarioError("FOLDER", str(folder), "must be a folder")
    whole_number(options.samples, "--samples", 1, 10**5)
    thread_count(options.threads, "--threads")
    entries: list[Entry] = []
    try:
        files = list(main_files(folder))
        with suppress(OSError):  # the check refuses what it could not make
            options.html.parent.mkdir(parents=True, exist_ok=True)
        check_place("--html", options.html)
        for number, path in enumerate(files, 1):
            print(f"{number} of {len(files)}: {path}", flush=True)
            entry = _entry(folder, path, samples=options.samples, threads=options.threads)
            _show(entry)
            page = atlas_page(folder, [*entries, entry], samples=options.samples)
            write_text(options.html, page)
            entries.append(entry)
    except KeyboardInterrupt as interrupt:
        done = f"{options.html} has the first {len(entries)} of the files"
        interrupt.add_note(done if entries else "no page was written")
        raise
    print(f"{_conclusion(entries)}\nThe page is in {options.html}" if entries else "no model file")
    return 0


def main_files(folder: Path) -> Iterator[Path]:
    """Yield the model files of a folder that no other file includes and that are not only macros.

    A file included by an MJCF scene is a model and is read instead of the scene. Files that cannot
    be read, are too large or hold no model come last; reading them gives the reason.

    Parameters
    ----------
    folder : Path
        Folder of repositories; hidden folders and links are skipped.

    Yields
    ------
    Path
        Path relative to the folder, sorted.

    Raises
    ------
    ScenarioError
        If there are too many files.
    """
    found: dict[Path, bytes] = {}
    unread: list[Path] = []
    for place, folders, names in os.walk(folder):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        for name in sorted(names):
            path = Path(place, name)
            if path.suffix in _KINDS and path.is_file() and not path.is_symlink():
                try:
                    with path.open("rb") as file:
                        data = file.read(_LARGEST + 1)
                except OSError:
                    unread.append(path.relative_to(folder))
                    continue
                is_model = _ROOTS.search(data) is not None
                if is_model and len(data) <= _LARGEST:
                    found[path.relative_to(folder)] = data
                elif is_model or path.suffix not in _ANYTHING:
                    unread.append(path.relative_to(folder))
            if len(found) > _MOST:
                raise ScenarioError("FOLDER", str(folder), f"must have at most {_MOST} model files")
    named = {
        (_repository(path), Path(each.decode(errors="replace")).name)
        for path, data in found.items()
        if not _is_mjcf(data)
        for each in _NAMED.findall(data)
    }
    for path, data in found.items():
        is_included = (_repository(path), path.name) in named
        if not is_included and _LINKS.search(_MACROS.sub(b"", data)):
            yield path
    yield from unread


def _repository(path: Path) -> str:
    """Name the repository of a file; files outside of repositories also get one."""
    return path.parts[0] if len(path.parts) > 1 else ""


def _is_mjcf(data: bytes) -> bool:
    """Whether a file is MJCF; of a scene, the included files are the robots."""
    root = _ROOTS.search(data)
    return root is not None and root[1] == b"mujoco"


def _entry(folder: Path, path: Path, *, samples: int, threads: int | None) -> Entry:
    """Read and audit a file with default options."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ScenarioWarning)  # the reading has the warnings
        try:
            reading = read_robot(folder / path)
        except (Crawler2dError, ImportError, OSError) as error:
            return Entry(path=path, refusal=str(error))
        try:
            found = audit(reading, samples=samples, threads=threads, progress=False)
        except Crawler2dError as error:
            return Entry(path=path, reading=reading, refusal=str(error))
    return Entry(path=path, reading=reading, audit=found)


def _show(entry: Entry) -> None:
    print(f"    {entry.refusal or _verdict(entry)}", flush=True)


def _verdict(entry: Entry) -> str:
    assert entry.audit is not None  # or there is a refusal
    return " ".join(words.conclusion(entry.audit))


def atlas_page(folder: Path, entries: Sequence[Entry], *, samples: int = _SAMPLES) -> str:
    """Write the page of an atlas.

    Parameters
    ----------
    folder : Path
        Folder of the repositories.
    entries : sequence of Entry
        Model files.
    samples : int
        Number of samples of each audit.
    """
    sections = []
    for name in dict.fromkeys(entry.path.parts[0] for entry in entries):
        own = [entry for entry in entries if entry.path.parts[0] == name]
        licence = f'<p class="origin">{escape(licence_of(folder / name))}</p>'
        cards = "".join(_card(entry) for entry in own if entry.reading is not None)
        cards += _refused([entry for entry in own if entry.reading is None])
        sections.append(f"<section><h2>{escape(name)}</h2>{licence}{cards}</section>")
    return fill_page(
        "atlas.html",
        read_part("atlas.css", _HERE),
        "",
        _HERE,
        title="Atlas of tracked robots",
        conclusion=escape(_conclusion(entries)),
        entries="\n".join(sections),
        how=f"each file read with default options, audited with {samples} samples of its unknowns",
    )


def _conclusion(entries: Sequence[Entry]) -> str:
    read = [entry for entry in entries if entry.reading is not None]
    seizing = [entry for entry in entries if entry.audit is not None and entry.audit.seizes]
    repaired = [
        e for e in seizing if e.audit is not None and any(r.confirmed for r in e.audit.repairs)
    ]
    return (
        f"{len(read)} of {len(entries)} model files were read. Robots that seize where a belt"
        f" clears: {len(seizing)}, with a confirmed repair: {len(repaired)}."
    )


def _refused(entries: Sequence[Entry]) -> str:
    rows = "".join(
        f"<li>{escape(e.path.as_posix())}: <span>{escape(e.refusal)}</span></li>" for e in entries
    )
    if not rows:
        return ""
    return f"<details><summary>{len(entries)} not read</summary><ul>{rows}</ul></details>"


def _card(entry: Entry) -> str:
    name = f"<h3>{escape(entry.path.as_posix())}</h3>"
    reading, found = entry.reading, entry.audit
    assert reading is not None  # others are only listed
    drawing = draw_robot(reading.robot, "side view", reading.silhouettes, width=300, height=200)
    parts = [drawing, name, f"<p>{escape(reading.description)}</p>"]
    if found is None:
        parts.append(f'<p class="bad">{escape(entry.refusal)}</p>')
        return f"<article>{''.join(parts)}</article>"
    look = "bad" if found.seizes else "good"
    parts.append(f'<p class="{look}">{escape(_verdict(entry))}</p>')
    if found.repairs:
        parts.append(f"<p>{escape(words.repair_sentence(found.repairs[0]))}</p>")
    lint = "".join(
        f"<li>{escape(each.severity)}: {escape(each.message)} {escape(each.where)}</li>"
        for each in found.lint
    )
    if lint:
        parts.append(
            f"<details><summary>{len(found.lint)} findings</summary><ul>{lint}</ul></details>"
        )
    return f"<article>{''.join(parts)}</article>"


def licence_of(repository: Path) -> str:
    """Describe the licence of a repository, as stated by its files.

    Parameters
    ----------
    repository : Path
        Its folder, or a file.
    """
    if not repository.is_dir():
        return "licence: none found"
    statements = []
    for path in sorted(repository.glob("*")):
        if re.match(r"(?i)(licen[cs]e|copying)", path.name) and path.is_file():
            lines = _beginning(path).splitlines()
            first = next((line.strip() for line in lines if line.strip()), "")
            statements.append(f"{path.name}: {first[:80]}")
    for path in sorted(filter(Path.is_file, repository.rglob("package.xml")))[:1]:
        if stated := re.search(r"<license[^>]*>([^<]*)</license>", _beginning(path)):
            statements.append(f"package.xml: {stated[1].strip()[:80]}")
    return f"licence: {'; '.join(statements) or 'none found'}"


def _beginning(path: Path) -> str:
    """Read the beginning of a text; "" if it cannot be read."""
    try:
        with path.open(encoding="utf-8", errors="replace") as file:
            return file.read(100_000)
    except OSError:
        return ""
