"""``report.html`` of a folder: what it shows; written once, or whenever a sweep gets on."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from simmpp.common.files import Row, write_text
from simmpp.common.folders import is_at_work
from simmpp.report.page.arrangement import abscissas
from simmpp.report.page.beside import beside
from simmpp.report.page.depth import depth_of
from simmpp.report.page.figures.figure import Figure, figure_data
from simmpp.report.page.figures.groups import (
    CAPACITY_ID,
    FIGURE_GROUPS,
    LIMITS_ID,
    MACHINES_ID,
    FigureGroup,
)
from simmpp.report.page.findings import further, wins
from simmpp.report.page.folder import Folder, read_folder
from simmpp.report.page.glossary import glossary
from simmpp.report.page.limits import (
    PointLimits,
    limit_sentences,
    limit_table,
    limits_of_points,
)
from simmpp.report.page.origin import facts, origin
from simmpp.report.page.standing import Warned, standing_of, warnings_of
from simmpp.report.page.template import rendered
from simmpp.report.page.together import warnings_of_all
from simmpp.run import words
from simmpp.run.rows import RESULTS
from simmpp.studies.nebel98.verdict import DOES_NOT, HOLDS, IN_PART
from simmpp.sweeps.winners.answer import answer
from simmpp.sweeps.winners.contest import replicated_policies
from simmpp.sweeps.winners.fit_table import fit_table
from simmpp.sweeps.winners.knee import knee_table
from simmpp.sweeps.winners.machines import machines_of
from simmpp.sweeps.winners.machines_told import machine_table
from simmpp.sweeps.winners.points import Points, points_of
from simmpp.sweeps.winners.sentence import Sentence

PAGE = "report.html"
LOOK_S = 1.0
"""Seconds between two looks at the tables of a sweep that runs."""

LIMITS_SUMMARY = "The fastest dataflow of each case, part by part"
MACHINES_SUMMARY = "Each machine with each number of nodes"
FITS_SUMMARY = "Which policies fit where, and what they lack"
KNEES_SUMMARY = (
    "The least capacity with a makespan of at most so many times that of unbounded memory"
)


class Table(NamedTuple):
    """A table of a group of figures."""

    name: str
    of_many: str
    """Its name where it is folded, as it has many lines."""
    summary: str
    """What stands above it then."""
    lines: Sequence[Row]


@dataclass(frozen=True)
class Report:
    """A folder's rows, the points they make, and the figures of these."""

    folder: Folder
    limits: PointLimits
    groups: Mapping[FigureGroup, Sequence[Figure]]
    """Those of which there are figures."""

    @property
    def points(self) -> Points:
        """Those of the rows."""
        return self.limits.points

    @property
    def figures(self) -> list[Figure]:
        """Those of all groups, in the order of the page."""
        return [figure for figures in self.groups.values() for figure in figures]

    def warnings(self, *, is_followed: bool = False) -> list[Warned]:
        """What readers have to know of the folder, or of several."""
        if self.folder.parts:
            return warnings_of_all(self.folder.parts)
        return warnings_of(self.folder, is_followed=is_followed)


def report_of(folder: Folder) -> Report:
    """Work out what the rows of a folder show."""
    points = points_of(
        folder.rows, folder.further, folder.profits, folder.labels, folder.confidence
    )
    limits = limits_of_points(folder, points)
    has_runs = any(points.runs) or any(points.unfit)
    figures = {
        group: list(group.figures(folder, limits))
        for group in FIGURE_GROUPS
        if has_runs or not group.of_points
    }
    return Report(folder, limits, {group: of for group, of in figures.items() if of})


def write_page(
    report: Report,
    *,
    is_running: bool = False,
    stills: Collection[str] = (),
    path: Path | None = None,
) -> Path:
    """Write ``report.html``, or the file ``path``; one that is running reloads itself.

    ``stills`` are the stems of the figures' files that there will be beside it.
    """
    path = path or report.folder.path / PAGE
    write_text(rendered("report.html", _values(report, is_running, stills)), path)
    return path


def follow(path: Path) -> Iterator[Folder]:
    """Write the page of what is there, again and again; ends when no sweep works there any more.

    Yields what each page shows; the last one reloads itself no more.
    """
    seen = None
    while is_at_work(path):
        results = path / RESULTS
        written = results.stat().st_mtime_ns if results.is_file() else None
        if written is not None and written != seen:
            seen = written  # pages of a megabyte are not written again for nothing new
            yield _write(path, is_running=True)
        time.sleep(LOOK_S)
    yield _write(path, is_running=False)


def _write(path: Path, *, is_running: bool) -> Folder:
    folder = read_folder(path)
    write_page(report_of(folder), is_running=is_running)
    return folder


def _values(report: Report, is_running: bool, stills: Collection[str]) -> dict[str, Any]:
    folder, points = report.folder, report.points
    pictures = [] if folder.parts else beside(folder.path)
    along = abscissas(points.axes)[0]
    machines = machines_of(points, folder.record)
    answered = [] if _has_no_rows(report) else answer(points, machines)
    said, warned = _sentences(report), report.warnings(is_followed=is_running)
    made = origin(folder)
    return {
        "title": folder.title or "report",
        "facts": facts(folder),
        "live": f"running: {standing_of(folder).progress}" if is_running else "",
        "warnings": warned,
        "answer": answered,
        "flows": _flows(report.points),
        "sentences": said,
        "tables": {
            LIMITS_ID: [
                Table(
                    *("What limits it", "What limits the fastest", LIMITS_SUMMARY),
                    limit_table(report.limits),
                )
            ],
            MACHINES_ID: [
                Table(
                    *("Machines in seconds", "Machines in seconds", MACHINES_SUMMARY),
                    machine_table(machines),
                )
            ],
            CAPACITY_ID: [
                Table("What fits", "What fits", FITS_SUMMARY, fit_table(points)),
                Table("Knees", "Knees", KNEES_SUMMARY, knee_table(points)),
            ],
        },
        "wins": wins(points),
        "along": {"policy": "", "fraction": "scene in memory"}.get(along, along),
        "claims": folder.claims,
        "verdicts": _verdicts(folder),
        "groups": [(g.id, g.name, g.text, figures) for g, figures in report.groups.items()],
        "stills": None if is_running else stills,
        "has_points": any(points.runs),
        "beside": pictures,
        "sections": [
            *([("claims", "Claims")] if folder.claims else []),  # what a reproduction is for
            *([("summary", "Summary")] if answered or said or warned else []),
            *((group.id, group.name) for group in report.groups),
            *([("point", "One point"), ("rows", "All points")] if any(points.runs) else []),
            *((id, name) for id, name, _, _ in pictures),
            *([("made", "How it was made")] if made else []),
        ],
        "origin": made,
        "made": "Made by simmpp from the rows in this folder; nothing is loaded from anywhere.",
        "data": _data(report, is_running),
    }


def _sentences(report: Report) -> list[Sentence]:
    if _has_no_rows(report):
        return []
    return [*further(report.points), *limit_sentences(report.limits)]


def _has_no_rows(report: Report) -> bool:
    """It is of ``bench``, and nothing else is there."""
    return bool(report.folder.bench) and not report.folder.rows


def _flows(points: Points) -> str:
    """What the policies of a page do, in the words of the guide."""
    meanings = {word.name: word.text for word in glossary()}
    flows = dict.fromkeys(words.policy(points.name(n)) for n in range(len(points.profits)))
    return "; ".join(f"{flow}: {meanings[flow]}" for flow in flows if flow in meanings)


def _verdicts(folder: Folder) -> str:
    """How many claims hold, in part, and do not."""
    counts = Counter(claim["holds"] for claim in folder.claims)
    forms = {HOLDS: (HOLDS, "hold"), IN_PART: (IN_PART, IN_PART), DOES_NOT: (DOES_NOT, "do not")}
    parts = [
        f"{counts[kind]} {one if counts[kind] == 1 else more}"
        for kind, (one, more) in forms.items()
        if counts[kind]
    ]
    return f"Of {len(folder.claims)} claims: {', '.join(parts)}."


def _data(report: Report, is_running: bool) -> dict[str, Any]:
    """What the scripts of the page read."""
    return {
        "figures": {figure.stem: figure_data(figure) for figure in report.figures},
        "depth": depth_of(report.points, report.limits),
        "first": _first(report.points),
        "live": is_running,
    }


def _first(points: Points) -> int:
    """The point shown before one is chosen: the dataflow that gains most."""
    ceilings = replicated_policies(points)
    gains = {
        number: float(row["time_profit"])
        for number, row in enumerate(points.profits)
        if words.is_finite(row["time_profit"]) and row["policy"] not in ceilings
    }
    return max(gains, key=lambda number: gains[number], default=0)
