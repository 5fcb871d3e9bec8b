"""Two sweeps side by side as a page: what differs, and the curves of both."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from simmpp.common.files import write_text
from simmpp.common.units import counted
from simmpp.report.page.arrangement import axes_of
from simmpp.report.page.difference import BEYOND, Difference, line, ranked, summary
from simmpp.report.page.figure import Figure, figure_data
from simmpp.report.page.folder import Folder
from simmpp.report.page.profit_figures import ProfitData, profit_figures
from simmpp.report.page.template import rendered
from simmpp.run.provenance import difference

MOST_CHANGES = 300
"""Lines of the page's table."""


def write_comparison(before: Folder, after: Folder, found: Difference, path: Path) -> None:
    """Write the page."""
    changes = ranked(found.changes)
    figures = _figures(found)
    values = {
        "title": f"{_name(before)} and {_name(after)}",
        "facts": [f"before: {before.path}", f"after: {after.path}"],
        "live": "",
        "sections": [("summary", "Summary"), ("curves", "Curves"), ("changes", "What moved")],
        "sentences": [verdict(found), *reasons(before, after)],
        "summary": summary(found),
        "figures": figures,
        "changes": [line(change) for change in changes[:MOST_CHANGES]],
        "beyond": BEYOND,
        "hidden": max(0, len(changes) - MOST_CHANGES),
        "only": [("only before", found.only_before), ("only after", found.only_after)],
        "made": "Made by simmpp from the rows of two folders; nothing is loaded from anywhere.",
        "data": {"figures": {figure.stem: figure_data(figure) for figure in figures}},
    }
    write_text(rendered("compare.html", values), path)


def _name(folder: Folder) -> str:
    return folder.path.resolve().name


def verdict(found: Difference) -> str:
    """What there is to see, in one sentence."""
    moved = {change.number for change in found.changes}
    sure = {change.number for change in found.changes if change.certainty == BEYOND}
    text = f"{counted(found.common, 'point')} in both"
    for name, points in (("before", found.only_before), ("after", found.only_after)):
        text += f", {len(points)} only {name}" if points else ""
    if not moved:
        return f"{text}; nothing moved."
    return f"{text}; {len(moved)} moved, {len(sure) or 'none'} beyond the 95 % interval."


def reasons(before: Folder, after: Folder) -> list[str]:
    """Settings and machines that are not the same: why values may have moved."""
    found = []
    for key in ("config", "versions"):
        old, new = ({key: folder.record.get(key, {})} for folder in (before, after))
        if problem := difference(old, new, "before", "after"):
            found.append(problem)
    return found


def _figures(found: Difference) -> list[Figure]:
    marked = {
        measure.replace(" ", "_"): frozenset(
            c.number for c in found.changes if c.measure == measure and c.certainty == BEYOND
        )
        for measure in ("time profit", "message profit")
    }
    rows = [*found.after.profits, *found.before.profits]
    if not rows:
        return []
    axes: Mapping[str, Any] = axes_of(rows, found.after.further)
    return list(profit_figures(ProfitData(found.after.profits, axes, found.before.profits, marked)))
