"""The figures of a report, group by group: a further figure is a file and a line here."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from simmpp.report.page.figures import accuracy, bar_figures, paper, profit_figures
from simmpp.report.page.figures.figure import Figure
from simmpp.report.page.figures.profit_figures import ProfitData
from simmpp.report.page.folder import Folder
from simmpp.sweeps.winners.points import Points

CLICKING = "Click a point to see it in depth; click a name to hide its curve."


@dataclass(frozen=True)
class FigureGroup:
    """Figures under one heading of the page, and what makes them."""

    id: str
    name: str
    text: str
    stems: tuple[str, ...]
    """Beginnings of the stems of its figures' files: these are no pictures that others left."""
    figures: Callable[[Folder, Points], Iterable[Figure]]
    of_points: bool = True
    """Not asked for figures where no point has rows."""


FIGURE_GROUPS = (
    FigureGroup("paper", "The paper's figures", CLICKING, paper.STEMS, paper.paper_figures),
    FigureGroup(
        *("curves", "Curves", CLICKING, profit_figures.STEMS),
        lambda _, points: profit_figures.profit_figures(ProfitData(points)),
    ),
    FigureGroup(
        *("accounts", "Time and messages", "", bar_figures.STEMS),
        lambda _, points: bar_figures.bar_figures(points),
    ),
    FigureGroup(
        *("accuracy", "Run time against error", "", (accuracy.STEM,)),
        lambda folder, _: accuracy.accuracy_figures(folder.bench, paper.SCENE_NAMES),
        of_points=False,
    ),
)
