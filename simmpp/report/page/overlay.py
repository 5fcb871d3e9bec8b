"""Profit curves of a sweep over those of an earlier one, where they differ, in one picture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from simmpp.plot.curves import Panel
from simmpp.plot.matplotlib_panels import draw
from simmpp.report.page.figures.profit_figures import ProfitData, profit_figures
from simmpp.report.page.figures.stills import titled
from simmpp.report.page.folder import numbers_of
from simmpp.sweeps.profits import profit_columns
from simmpp.sweeps.winners.points import points_of_profits

NOTE = "wide and pale: before"
MOST_OVERLAID = 48
"""Panels of one picture."""


def overlay(
    before: Sequence[Mapping[str, str]], now: Sequence[Mapping[str, str]], stem: Path
) -> list[Path]:
    """Draw rows of ``profits.csv`` over earlier ones as ``stem``.png and .svg; returns these.

    Panels whose curves are the same are left out; if all are, there is no picture.
    """
    old, new = numbers_of(before), numbers_of(now)
    rows = [*new, *old]
    common = [name for name in rows[0] if name in rows[-1]]
    further = [name for name in common if name not in profit_columns()]
    points = points_of_profits(new, further)
    figures = profit_figures(ProfitData(points, points_of_profits(old, further)))
    panels = [
        titled(replace(panel, note=NOTE), figure, plate)
        for figure in figures
        for plate, of_plate in figure.plates.items()
        for panel in of_plate
        if isinstance(panel, Panel) and _has_moved(panel)
    ]
    return draw(panels[:MOST_OVERLAID], stem) if panels else []


def _has_moved(panel: Panel) -> bool:
    before, now = (
        {curve.label: curve.points for curve in panel.curves if curve.is_before == is_before}
        for is_before in (True, False)
    )
    return before != now
