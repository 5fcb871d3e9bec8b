"""Two sweeps side by side as a page: what differs, and the curves of both."""

from __future__ import annotations

from pathlib import Path

from simmpp.common.files import write_text
from simmpp.common.units import counted
from simmpp.report.page.difference import BEYOND, SideBySide, changes_by_measure, line, ranked
from simmpp.report.page.figures.figure import Figure, figure_data
from simmpp.report.page.figures.profit_figures import ProfitData, profit_figures
from simmpp.report.page.folder import Folder
from simmpp.report.page.template import rendered
from simmpp.run.provenance import difference

MOST_CHANGES = 300
"""Lines of the page's table."""


def write_comparison(before: Folder, after: Folder, sweeps: SideBySide, path: Path) -> None:
    """Write the page."""
    changes = ranked(sweeps.changes)
    figures = _figures(sweeps)
    values = {
        "title": f"{_name(before)} and {_name(after)}",
        "facts": [f"before: {before.path}", f"after: {after.path}"],
        "live": "",
        "sections": [("summary", "Summary"), ("curves", "Curves"), ("changes", "What moved")],
        "sentences": [outcome(sweeps), *causes(before, after)],
        "summary": changes_by_measure(sweeps),
        "figures": figures,
        "changes": [line(change) for change in changes[:MOST_CHANGES]],
        "beyond": BEYOND,
        "hidden": max(0, len(changes) - MOST_CHANGES),
        "only": [("only before", sweeps.only_before), ("only after", sweeps.only_after)],
        "made": "Made by simmpp from the rows of two folders; nothing is loaded from anywhere.",
        "data": {"figures": {figure.stem: figure_data(figure) for figure in figures}},
    }
    write_text(rendered("compare.html", values), path)


def _name(folder: Folder) -> str:
    return folder.path.resolve().name


def outcome(sweeps: SideBySide) -> str:
    """What there is to see, in one sentence."""
    moved = {change.number for change in sweeps.changes}
    sure = {change.number for change in sweeps.changes if change.certainty == BEYOND}
    text = f"{counted(sweeps.common, 'point')} in both"
    for name, points in (("before", sweeps.only_before), ("after", sweeps.only_after)):
        text += f", {len(points)} only {name}" if points else ""
    if not moved:
        return f"{text}; nothing moved."
    return f"{text}; {len(moved)} moved, {len(sure) or 'none'} beyond the 95 % interval."


def causes(before: Folder, after: Folder) -> list[str]:
    """Settings and machines that are not the same: why values may have moved."""
    problems = []
    for key in ("config", "versions"):
        old, new = ({key: folder.record.get(key, {})} for folder in (before, after))
        if problem := difference(old, new, "before", "after"):
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
