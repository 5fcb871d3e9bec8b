"""Two sweeps side by side, or several beside a first one, as a page: what differs, and curves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from simmpp.common.files import write_text
from simmpp.common.units import counted
from simmpp.report.page.difference import (
    BEYOND,
    NAMES,
    SideBySide,
    apart,
    changes_by_measure,
    difference_of,
    line,
    ranked,
)
from simmpp.report.page.figures.figure import Figure, figure_data
from simmpp.report.page.figures.profit_figures import ProfitData, profit_figures
from simmpp.report.page.folder import Folder
from simmpp.report.page.standing import warnings_of_each
from simmpp.report.page.template import rendered
from simmpp.run import words
from simmpp.run.provenance import difference

MOST_CHANGES = 300
"""Lines of the page's table."""


@dataclass(frozen=True)
class Comparison:
    """A sweep beside the first one."""

    before: Folder
    after: Folder
    sweeps: SideBySide

    @property
    def name(self) -> str:
        """What both are called, in the order of time."""
        return " and ".join(self.sweeps.names)


def compared(folders: Mapping[str, Folder]) -> list[Comparison]:
    """The first of several folders with each of the others, by their names."""
    (first, before), *others = folders.items()
    return [
        Comparison(before, after, difference_of(before, after, (first, name)))
        for name, after in others
    ]


def write_comparison(folders: Mapping[str, Folder], path: Path) -> None:
    """Write the page of the first of several folders with each of the others."""
    pairs = compared(folders)
    parts = [_part(pair, f"-{n}" if n > 1 else "") for n, pair in enumerate(pairs, 1)]
    figures = [figure for part in parts for figure in part["figures"]]
    values = {
        "title": words.any_of(_titles(folders), "and"),
        "facts": [f"{name}: {folder.path}" for name, folder in folders.items()],
        "live": "",
        "sections": [section for part in parts for section in part["sections"]],
        "warnings": warnings_of_each(folders),
        "parts": parts,
        "beyond": BEYOND,
        "made": "Made by simmpp from the rows of these folders; nothing is loaded from anywhere.",
        "data": {"figures": {figure.stem: figure_data(figure) for figure in figures}},
    }
    write_text(rendered("compare.html", values), path)


def _titles(folders: Mapping[str, Folder]) -> list[str]:
    if tuple(folders) != NAMES:
        return list(folders)
    return [folder.path.resolve().name for folder in folders.values()]


def _part(pair: Comparison, suffix: str) -> dict[str, Any]:
    """What the page says of one of the others; ``suffix`` tells its ids from those of the next."""
    sweeps, changes = pair.sweeps, ranked(pair.sweeps.changes)
    figures = [replace(figure, stem=figure.stem + suffix) for figure in _figures(sweeps)]
    heading = "" if sweeps.names == NAMES else pair.name
    sections = {"summary": "Summary", "curves": "Curves", "changes": "What moved"}
    return {
        "suffix": suffix,
        "names": sweeps.names,
        "headings": {id: ": ".join(filter(None, (heading, n))) for id, n in sections.items()},
        "sections": [
            (id + suffix, ": ".join(filter(None, (heading, name)))) for id, name in sections.items()
        ],
        "sentences": [outcome(sweeps), *causes(pair.before, pair.after, sweeps.names)],
        "summary": changes_by_measure(sweeps),
        "figures": figures,
        "changes": [line(change, sweeps.names) for change in changes[:MOST_CHANGES]],
        "hidden": max(0, len(changes) - MOST_CHANGES),
        "only": sweeps.only,
    }


def outcome(sweeps: SideBySide) -> str:
    """What there is to see, in one sentence."""
    if not sweeps.common:
        why = apart(sweeps)
        return f"no point is in both, so there is nothing to compare{f': {why}' if why else ''}."
    moved = {change.number for change in sweeps.changes}
    sure = {change.number for change in sweeps.changes if change.certainty == BEYOND}
    text = f"{counted(sweeps.common, 'point')} in both"
    text += f" ({sweeps.failed} of them without a result in one or both)" if sweeps.failed else ""
    for name, points in sweeps.only:
        text += f", {len(points)} only {name}" if points else ""
    if sweeps.failed == sweeps.common:
        return f"{text}: there is nothing to compare."
    if not moved:
        return f"{text}; nothing moved."
    return f"{text}; {len(moved)} moved, {len(sure) or 'none'} beyond the 95 % interval."


def causes(before: Folder, after: Folder, names: tuple[str, str] = NAMES) -> list[str]:
    """Settings and machines that are not the same: why values may have moved."""
    problems = []
    sides = names if names == NAMES else tuple(f"in {name}" for name in names)
    for key in ("config", "versions"):
        old, new = ({key: folder.record.get(key, {})} for folder in (before, after))
        if problem := difference(old, new, *sides):
            problems.append(problem)
    return problems


def _figures(sweeps: SideBySide) -> list[Figure]:
    marked = {
        measure.replace(" ", "_"): frozenset(
            c.number for c in sweeps.changes if c.measure == measure and c.certainty == BEYOND
        )
        for measure in ("time profit", "message profit")
    }
    if not sweeps.after.profits and not sweeps.before.profits:
        return []
    return list(profit_figures(ProfitData(sweeps.after, sweeps.before, marked)))
