"""The page of an audit, without a browser: its content, and that it is harmless."""

import base64
import dataclasses
import hashlib
import html
import json
import re
from collections.abc import Iterator
from html.parser import HTMLParser
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.audits import words
from crawler2d.audits.candidates import pockets
from crawler2d.audits.page import audit_page, simulate_replays
from crawler2d.audits.page.chart import chart_section
from crawler2d.audits.page.drawings import draw_pockets, draw_robot
from crawler2d.audits.page.sections import repair_section
from crawler2d.audits.repairs import Repair
from crawler2d.pictures.page.recording import recording
from tests.audits.seizing import QUIET, SEIZING, STEP, seizing_file

HOSTILE = "</script><img src=x onerror=alert(1)> $data ${title} \"' & <!-- ]]> \u2028"
VOID = {"meta", "link", "br", "input"}


class Page(HTMLParser):
    """Tags with their attributes and the text inside each; tags that do not match are an error."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.texts: list[str] = []
        self._open: list[int] = []
        self.feed(text)
        self.close()
        assert self._open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        assert len(dict(attrs)) == len(attrs)
        self.tags.append((tag, dict(attrs)))
        self.texts.append("")
        if tag not in VOID:
            self._open.append(len(self.tags) - 1)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        self.texts.append("")

    def handle_endtag(self, tag: str) -> None:
        assert self.tags[self._open.pop()][0] == tag

    def handle_data(self, data: str) -> None:
        for number in self._open:
            self.texts[number] += data

    def all(self, tag: str, **attributes: str) -> Iterator[tuple[dict[str, str | None], str]]:
        """Yield attributes and text of elements with a tag and these attributes."""
        for (name, found), text in zip(self.tags, self.texts, strict=True):
            if name == tag and attributes.items() <= found.items():
                yield found, text

    def rows(self, label: str) -> list[list[str]]:
        """Return the cells of the table in the box with a label."""
        start = next(
            k for k, (_, found) in enumerate(self.tags) if found.get("aria-label") == label
        )
        rows: list[list[str]] = []
        for (tag, found), text in zip(self.tags[start + 2 :], self.texts[start + 2 :], strict=True):
            if tag == "table":
                break
            if tag == "tr":
                rows.append([])
            if tag == "td" or (tag == "th" and found.get("scope") == "row"):
                rows[-1].append(text)
        return [row for row in rows if row]

    def data(self, name: str) -> Any:
        """Return the data of an inert script."""
        ((_, text),) = self.all("script", id=name)
        return json.loads(text)


@pytest.fixture(scope="module")
def page(found: c2d.Audit) -> Page:
    return Page(found.to_html())


@pytest.fixture(scope="module")
def file_page(of_file: c2d.Audit) -> Page:
    return Page(of_file.to_html())


# Harmless


@pytest.mark.parametrize("name", ["found", "of_file"])
def test_the_page_needs_nothing_from_outside(name: str, request: pytest.FixtureRequest) -> None:
    text = request.getfixturevalue(name).to_html()
    assert text.startswith("<!doctype html>")
    known = text.replace("http-equiv", "").replace('xmlns="http://www.w3.org/2000/svg"', "")
    assert "http" not in known
    assert not [word for word in ("@import", "url(", "fetch(", "import(", "//cdn") if word in text]
    for _, attributes in Page(text).tags:
        assert not {"src", "srcset", "action", "data", "style"} & set(attributes)
        assert not [each for each in attributes if each.startswith("on")]
        link = attributes.get("href") or "data:,"
        assert link == "data:," or link.startswith("#")


def test_the_policy_lets_the_script_of_the_page_run_and_nothing_else(page: Page) -> None:
    ((policy, _),) = page.all("meta", **{"http-equiv": "Content-Security-Policy"})
    content = policy["content"] or ""
    assert content.startswith("default-src 'none'; img-src data:;")
    ((_, style),) = page.all("style")
    (script,) = [text for found, text in page.all("script") if not found]
    for text in (style, script):
        digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        assert f"'sha256-{digest}'" in content
    assert content.count("sha256-") == 2


def test_every_link_has_a_target_and_every_name_is_there_once(file_page: Page) -> None:
    names = [found["id"] for _, found in file_page.tags if found.get("id")]
    assert len(names) == len(set(names))
    links = [found["href"] for found, _ in file_page.all("a")]
    assert links == ["#replay-0"]
    assert {(link or "")[1:] for link in links} <= set(names)


def test_names_are_only_ever_text(of_file: c2d.Audit, tmp_path: Path) -> None:
    """Names of robot and links in a file, of the file, and of obstacles."""
    name = f"{HOSTILE}</TITLE><script>alert(1)</script>rouge-gorge é"
    path, harmless = tmp_path / "cart <b>&.urdf", tmp_path / "cart.urdf"
    quoted = html.escape(name.replace("\u2028", " "))
    path.write_text(seizing_file(quoted, quoted), encoding="utf-8")
    harmless.write_text(seizing_file(), encoding="utf-8")
    how: Any = {"samples": 2, "repeats": 1, "repair": False, "seed": 3, **QUIET}
    obstacles = {f"{label}{name}": each for label, each in of_file.obstacles.items()}
    found = c2d.audit(path, obstacles, **how)
    assert found.robot.name == name.replace("\u2028", " ")
    hostile = Page(audit_page(found, {"no such repair": name}))
    page = Page(c2d.audit(harmless, of_file.obstacles, **how).to_html())

    def kinds(of: Page) -> list[tuple[str, str | None]]:
        return [(tag, each.get("class")) for tag, each in of.tags]

    assert kinds(hostile) == kinds(page)
    ((_, title),) = hostile.all("title")
    assert title == f"{found.robot.name}: audit"
    assert [row[0] for row in hostile.rows("verdicts")] == list(obstacles)


# What it shows


def plain(text: str) -> str:
    return " ".join(text.split())


def answer(page: Page) -> str:
    ((_, text),) = page.all("p", **{"class": "answer"})
    return text


def test_the_page_begins_with_the_answer_and_the_worst_replay(found: c2d.Audit, page: Page) -> None:
    ((_, name),) = page.all("h1")
    ((_, subject),) = page.all("p", **{"class": "subject"})
    assert f"{name}: {subject}" == words.subject(found)
    assert answer(page) == (
        "It seizes on 1 of 1 obstacles where a belt clears: step of 75 mm (100 % of the runs),"
        " between wheels 1 and 2 of the chassis. What prevents that, confirmed in new runs:"
        " chassis: 5 wheels in place of 4."
    )
    before = page.tags[: [each.get("class") for _, each in page.tags].index("runs")]
    assert {tag for tag, _ in before} & {"table", "figure", "details", "li"} == set()


def test_the_answer_says_in_which_runs_it_seizes_against_the_rule(of_file: c2d.Audit) -> None:
    weak = dataclasses.replace(of_file.verdicts[0], result="not certain")
    sentence = answer(Page(dataclasses.replace(of_file, verdicts=(weak,)).to_html()))
    assert sentence.startswith(
        "By the rule it seizes nowhere, but in runs over 1 of 1 obstacles: step"
    )


def test_an_error_of_lint_stands_above_the_answer(of_file: c2d.Audit) -> None:
    error = dataclasses.replace(of_file.lint[0], severity="error")
    flawed = dataclasses.replace(of_file, lint=(error,))
    texts = [text for _, text in Page(flawed.to_html()).all("p")]
    above = texts.index(words.reservation(flawed))
    assert texts[above + 1].startswith("It seizes on")


def test_the_conclusion_is_that_of_the_short_form(found: c2d.Audit, page: Page) -> None:
    paragraphs = [text for _, text in page.all("p")]
    for sentence in words.conclusion(found):
        assert sentence in paragraphs
        assert sentence in plain(found.summary)


def test_every_figure_of_a_file_has_its_value_and_its_source(
    of_file: c2d.Audit, file_page: Page
) -> None:
    assert of_file.reading is not None
    rows = {row[0]: row[1:] for row in file_page.rows("figures with their sources")}
    sources = of_file.reading.sources
    assert len(rows) == len(sources)
    assert rows["mass"] == ["16 kg", sources["robot.mass"]]
    assert rows["outline: axle distance"][0] == "0.365 m"
    assert rows["drivetrain: rotor inertia"] == ["0 kg m^2", "cart.urdf:1: none"]
    assert rows["friction"] == ["1", sources["friction"]]
    marked = [text for _, text in file_page.all("strong", **{"class": "estimate"})]
    assert len(marked) == len(sources.estimates) > 0


def test_the_page_has_every_unknown_with_its_range(of_file: c2d.Audit, file_page: Page) -> None:
    rows = file_page.rows("uncertain, varied over the samples")
    assert [row[1] for row in rows] == [
        words.range_of(path, each) for path, each in of_file.unknown.items()
    ]
    assert any("centre of mass" in row[0] and "cart.urdf" in row[2] for row in rows)


def test_wheels_are_numbered_and_have_the_names_and_lines_of_the_file(
    of_file: c2d.Audit, file_page: Page
) -> None:
    assert of_file.reading is not None
    rows = file_page.rows("wheels of the left side")
    assert [row[0] for row in rows] == ["0", "1", "2", "3"]
    assert [row[4] for row in rows] == ["left_rear", "left_aft", "left_fore", "left_front"]
    lines = dict(zip(*(of_file.reading.wheels[key] for key in ("name", "line")), strict=True))
    assert [row[5] for row in rows] == [f"cart.urdf:{lines[row[4]]}" for row in rows]


def test_a_robot_that_is_slower_than_usual_has_a_page() -> None:
    slow = dataclasses.replace(SEIZING.drivetrain, max_speed=0.1)
    robot = dataclasses.replace(SEIZING, drivetrain=slow)
    few = c2d.audit(robot, STEP, unknown={}, repair=False, **QUIET)
    assert "side view of the robot" in few.to_html()


def test_lint_stands_errors_first(of_file: c2d.Audit, file_page: Page) -> None:
    items = [text for _, text in file_page.all("li") if ": " in text]
    for each in of_file.lint:
        assert any(
            each.severity in item and each.message in item and each.where in item for item in items
        )
    assert of_file.lint


def test_verdicts_are_those_of_the_audit(of_file: c2d.Audit, file_page: Page) -> None:
    rows = file_page.rows("verdicts")
    assert len(rows) == len(of_file.verdicts) == 2
    for row, each in zip(rows, of_file.verdicts, strict=True):
        assert tuple(row[: len(words.VERDICT_HEAD)]) == words.verdict_row(each)
    shown = [text for found, text in file_page.all("a")]
    assert shown == [each.obstacle for each in of_file.verdicts if each.jam_wheels]
    assert rows[0][len(words.VERDICT_HEAD)] == f"{of_file.verdicts[0].jam_wheels} of the chassis"
    seizes = words.VERDICT_HEAD.index("seizes")
    assert f"{100 * of_file.verdicts[0].seized.rate:.0f} %" in rows[0][seizes]


def test_repairs_are_those_of_the_audit(found: c2d.Audit, page: Page) -> None:
    rows = page.rows("repairs")
    assert [row[0] for row in rows] == [each.description for each in found.repairs]
    assert [row[1] for row in rows] == [words.confirmation(each) for each in found.repairs]
    assert [row[5] for row in rows] == [str(each.wheels or "belt") for each in found.repairs]
    labels = [str(each["aria-label"]) for each, _ in page.all("svg", role="img")]
    pictures = [label for label in labels if not label.startswith("where ")]
    assert pictures[:3] == [f"the robot: {each.description}" for each in found.repairs]


def test_without_repairs_the_page_says_whether_any_were_needed(found: c2d.Audit) -> None:
    asked_for_none = dataclasses.replace(found, repaired=None)
    assert "<p>No repairs were searched for.</p>" in repair_section(asked_for_none, {})


def test_where_it_can_jam_is_drawn_for_the_model_and_its_best_repair(
    found: c2d.Audit, page: Page
) -> None:
    labels = [str(each["aria-label"]) for each, _ in page.all("svg", role="img")]
    charts = [label for label in labels if label.startswith("where ")]
    assert len(charts) == 2
    assert charts[0] == "where the model can jam on a step, by height and friction"
    assert "between wheels 1 and 2" in chart_section(found.robot)


def test_numbers_of_a_chart_end_within_it() -> None:
    # A radius of 70 mm has the last number, 140, at the right end; a digit is 0.6 of 12 px wide.
    outline = dataclasses.replace(SEIZING.outline, front_radius=0.07, rear_radius=0.07)
    wheels = dataclasses.replace(SEIZING, outline=outline, track=c2d.LineOfWheels(4))
    text = chart_section(wheels)
    (width,) = set(map(float, re.findall(r'viewBox="0 0 ([\d.]+)', text)))
    labels = re.findall(r'<text x="([\d.]+)"[^>]*text-anchor="middle">(\d+)<', text)
    assert labels[-1][1] == "140"
    assert all(float(x) + 0.5 * 0.6 * 12.0 * len(number) < width for x, number in labels)


def test_a_chart_that_cannot_be_computed_says_why() -> None:
    gears = c2d.robots.engineer(track=c2d.LineOfWheels(5, wheel=c2d.GearWheel()))
    text = chart_section(gears)
    assert text.startswith("<p>Not computed: robot.track must have round wheels or a smooth belt")


def test_a_repair_without_a_chart_leaves_the_model_its_own(found: c2d.Audit) -> None:
    gears = found.robot.with_track(c2d.LineOfWheels(5, wheel=c2d.GearWheel()))
    text = chart_section(found.robot, [("gears <8>", gears)])
    assert text.startswith(chart_section(found.robot))
    assert "<p>Not computed for gears &lt;8&gt;: robot.track must have round wheels" in text


def test_a_diff_is_shown_with_its_repair(found: c2d.Audit, page: Page) -> None:
    diff = "--- a\n+++ b\n-<radius>0.06</radius>"
    shown = Page(audit_page(found, {found.repairs[0].description: diff}))
    assert next(text for _, text in shown.all("pre")) == diff
    assert not any("what changes in the file" in text for _, text in page.all("summary"))


def test_how_it_was_made_names_runs_seed_and_command(of_file: c2d.Audit, file_page: Page) -> None:
    rows = {row[0]: row[1] for row in file_page.rows("how it was made")}
    made = int((of_file.table["outcome"] != "").sum())
    assert made < 36
    said = rows["runs behind the verdicts"]
    assert said.startswith(f"{made}: at most 9 samples of the robot, 1 run each")
    assert rows["seed of the draws"] == "3"
    assert c2d.__version__ in rows["crawler2d"]
    *_, (_, again) = file_page.all("pre")
    # Custom obstacles are not an option of the command.
    assert of_file.reading is not None
    path = of_file.reading.path
    assert again.startswith(f"crawler2d.audit({str(path)!r}, obstacles=..., samples=9")
    changed = dataclasses.replace(of_file, call=dataclasses.replace(of_file.call, own=()))
    *_, (_, again) = Page(changed.to_html()).all("pre")
    assert again.startswith(f"crawler2d audit {path} --samples 9 --repeats 1 --seed 3")


# Replays


def test_every_obstacle_that_seized_has_a_replay_of_one_of_its_runs(
    of_file: c2d.Audit, file_page: Page
) -> None:
    seized = [each for each in of_file.verdicts if each.seized.rate > 0.0]
    assert [each.obstacle for each in seized] == ["step of 75 mm"]
    ((_, shown),) = file_page.all("div", **{"class": "runs"})
    assert [text for _, text in file_page.all("option") if "seized" in text] == [
        f"step of 75 mm: {words.percent(seized[0].seized.rate)} seized"
    ]
    (replay,) = simulate_replays(of_file)
    (own, belt), beside = replay.runs, replay.other
    assert beside == "the belt"
    assert own.outcome == c2d.Outcome.SEIZED
    assert belt.outcome == c2d.Outcome.CLEARED
    cell = of_file.table.sel(terrain="step of 75 mm")
    cell = cell.isel(sample=replay.sample, repeat=replay.repeat)
    for name, run in (("model", own), ("belt", belt)):
        there = cell.sel(model=name)
        assert there["identity"].item() == run.scenario.identity
        assert there["final_x"].item() == run.metrics["final_x"]
    assert "Seized between wheels 1 and 2: the ground at" in shown
    assert f"Sample {replay.sample}, repeat {replay.repeat}" in shown
    assert f"drive: speed {cell.sel(model='model')['drawn_speed'].item():.4g} m/s" in shown


def test_the_repaired_robot_is_replayed_next_to_the_original_with_the_same_draws(
    found: c2d.Audit, page: Page
) -> None:
    ((*_, (own, repaired), beside),) = simulate_replays(found)
    assert beside == "chassis: 5 wheels in place of 4 (confirmed)"
    assert repaired.scenario.robot.track == found.repairs[0].robot.track
    assert repaired.scenario == own.scenario.replace({"robot.track": found.repairs[0].robot.track})
    captions = [text for _, text in page.all("figcaption")][:2]
    assert captions[0].startswith("the model seized at")
    assert captions[1].startswith(f"{beside} cleared after")


def test_a_repair_by_wheels_is_shown_before_belts_and_a_confirmed_one_before_others(
    found: c2d.Audit,
) -> None:
    wheels, gears, belt = found.repairs
    assert found.repaired is not None

    def shown(*repairs: Repair) -> str:
        assert found.repaired is not None
        repaired = found.repaired._replace(repairs=repairs)
        return simulate_replays(dataclasses.replace(found, repaired=repaired))[0].other

    flawed = dataclasses.replace(wheels, confirmed=False)
    assert shown(belt, gears) == f"{gears.description} (confirmed)"
    assert shown(belt, flawed) == "belts moved by a track plugin (confirmed)"
    assert shown(flawed) == f"{wheels.description} (not confirmed)"


def test_a_repair_that_seizes_in_the_replayed_run_says_so(found: c2d.Audit) -> None:
    assert found.repaired is not None
    same = dataclasses.replace(found.repairs[0], robot=found.robot, confirmed=False)
    repaired = found.repaired._replace(repairs=(same,))
    page = Page(dataclasses.replace(found, repaired=repaired).to_html())
    ((_, sentence),) = page.all("p", **{"class": "diagnosis"})
    assert sentence.endswith("In this run the other robot seizes, too.")
    assert answer(page).endswith("No repair was confirmed.")


def test_a_repair_that_breaks_a_rule_with_the_draws_leaves_the_robot_alone(
    found: c2d.Audit, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert found.repaired is not None
    broken = found.robot.with_track(c2d.LineOfWheels(300, wheel_radius=0.0608))
    repair = dataclasses.replace(found.repairs[0], robot=broken)
    repaired = found.repaired._replace(repairs=(repair,))
    # It breaks the rule without the draws, too, and cannot be drawn.
    monkeypatch.setattr("crawler2d.audits.page.sections.draw_robot", lambda *_, **__: "")
    page = Page(dataclasses.replace(found, repaired=repaired).to_html())
    assert any("no result: " in text and "track.count" in text for _, text in page.all("p"))
    assert len(list(page.all("canvas"))) == len(page.data("runs-0")) == 1


def test_the_page_has_the_records_of_its_runs_thinned(
    of_file: c2d.Audit, file_page: Page, monkeypatch: pytest.MonkeyPatch
) -> None:
    ((*_, runs, _),) = simulate_replays(of_file)
    assert file_page.data("runs-0") == [json.loads(json.dumps(recording(run))) for run in runs]
    monkeypatch.setattr("crawler2d.pictures.page.pair._MOST", 30)
    for thinned, run in zip(Page(of_file.to_html()).data("runs-0"), runs, strict=True):
        assert thinned["samples"] == run.time.size > 31
        assert thinned["frames"]["count"] <= 31


def test_without_a_seizure_the_run_that_came_closest_is_shown() -> None:
    good = SEIZING.with_track(c2d.LineOfWheels(5, wheel_radius=0.0608))
    steps: Any = {"step of 30 mm": c2d.terrains.step(0.03), **STEP}
    found = c2d.audit(good, steps, unknown={}, repeats=4, repair=False, **QUIET)
    page = Page(found.to_html())
    assert answer(page).startswith("It seized in no run over 2 obstacles")
    (replay,) = simulate_replays(found)
    _, belt = replay.runs
    ways = found.table["time"].sel(model="model").transpose("terrain", "sample", "repeat")
    longest = (ways * found.table["speed"]).values
    of = [each.obstacle for each in found.verdicts].index(replay.verdict.obstacle)
    assert longest[of, replay.sample, replay.repeat] == longest.max()
    assert belt.scenario.robot == found.belt.robot
    ((_, sentence),) = page.all("p", **{"class": "diagnosis"})
    assert sentence == "It seized in no run; this is the one that came closest. It clears."


def test_a_robot_on_belts_has_a_page() -> None:
    found = c2d.audit(c2d.robots.engineer(flippers=None), STEP, samples=2, repeats=1, **QUIET)
    page = Page(found.to_html())
    assert any("no neighbouring wheels" in text for _, text in page.all("p"))
    assert len(list(page.all("canvas"))) == 1


def test_equal_audits_have_equal_pages(of_file: c2d.Audit) -> None:
    assert of_file.to_html() == of_file.to_html(threads=1)


def test_the_page_is_written_to_a_file(found: c2d.Audit, tmp_path: Path) -> None:
    path = tmp_path / "audit.html"
    assert found.to_html(str(path)) == path
    assert path.read_text(encoding="utf-8") == found.to_html()
    with pytest.raises(OSError, match="irectory"):
        found.to_html(tmp_path)


def test_a_page_with_one_pair_of_replays_has_less_than_150_kb(found: c2d.Audit, say: Any) -> None:
    size = len(found.to_html().encode())
    say(f"the page of an audit with one pair of replays has {size / 1e3:.0f} kB")
    assert size < 150_000


def test_the_parts_of_the_page_are_in_the_package() -> None:
    names = {path.name for path in files("crawler2d.audits.page").iterdir()}
    assert {"audit.html", "audit.css", "audit.js"} <= names


# Drawings


def circles(svg: str) -> list[tuple[float, ...]]:
    found = re.findall(r'<circle cx="([^"]*)" cy="([^"]*)" r="([^"]*)"', svg)
    return [tuple(map(float, each)) for each in found]


def test_the_robot_is_drawn_over_the_shapes_of_its_file(of_file: c2d.Audit) -> None:
    assert of_file.reading is not None
    shapes = of_file.reading.silhouettes
    svg = draw_robot(of_file.robot, "a cart", shapes)
    wheels, outlines = circles(svg), re.findall(r'<path d="([^"]*)" class="collision"', svg)
    assert len(wheels) == 4
    assert len(outlines) == 5  # the two sides coincide
    for x, y, radius in wheels:
        # A circle in pieces that are rounded to a tenth of a pixel begins at the rim of its wheel.
        starts = [np.array(re.findall(r"-?[\d.]+", each)[:2], float) for each in outlines]
        assert min(abs(np.hypot(*(each - (x, y))) - radius) for each in starts) < 0.2


def test_wheels_are_numbered_where_they_are() -> None:
    robot = c2d.robots.absolem(track="public")
    table = robot.wheels()
    left = table["side"] == "left"
    svg = draw_robot(robot, "Absolem")
    numbers = re.findall(r'<text x="([^"]*)" y="([^"]*)"[^>]*>([^<]*)</text>', svg)
    named = sorted(int(each) for *_, text in numbers for each in text.split(", "))
    assert named == sorted(table["body"][left].tolist())
    places = {(x, y) for x, y, _ in circles(svg)}
    assert all((float(x), float(y)) in places for x, y, _ in numbers)


def test_equal_pockets_are_drawn_once_and_all_to_one_scale() -> None:
    robot = c2d.robots.absolem(track="public")
    found = pockets(robot)
    radii = dict(zip(robot.wheels()["body"].tolist(), robot.wheels()["radius"], strict=True))
    figures = draw_pockets(robot, found).split("<figure>")[1:]
    assert 2 < len(figures) < len(found)
    scales = []
    for figure in figures:
        rear, front = re.findall(r"<strong>(\d+)-(\d+)", figure)[0]
        pocket = next(each for each in found if each.bodies == (int(rear), int(front)))
        (x, _, r), (u, _, s) = circles(figure)
        assert r / s == pytest.approx(radii[int(rear)] / radii[int(front)], rel=0.01)
        scales.append((u - x) / pocket.width)
        assert f"{1e3 * pocket.width:.1f} mm wide" in figure
    assert np.ptp(scales) < 0.01 * min(scales)  # to a tenth of a pixel
    text = " ".join(figures)
    assert all("-".join(map(str, each.bodies)) in text for each in found)


def test_wheels_that_touch_hold_at_any_friction() -> None:
    """Their walls are vertical at the bottom, except for rounding."""
    robot = c2d.robots.engineer(flippers=None, track=c2d.CircumferentialWheels(24))
    drawn = draw_pockets(robot, pockets(robot))
    assert set(re.findall(r"alone it holds ([^<]*)<", drawn)) == {"at any friction"}
