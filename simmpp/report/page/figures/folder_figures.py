"""Several folders over each other: a line is a folder, a panel is a dataflow."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from simmpp.policy.parameters import REFERENCE
from simmpp.report.page.figures.figure import Figure
from simmpp.report.page.figures.profit_figures import STEMS as PROFIT_STEMS
from simmpp.report.page.figures.profit_figures import ProfitData, profit_figures
from simmpp.report.page.together import FOLDER
from simmpp.run import words
from simmpp.sweeps.profits import MEASURES
from simmpp.sweeps.winners.points import Points

PREFIX = "folders-"
STEMS = tuple(PREFIX + stem for stem in PROFIT_STEMS)
FLAT = tuple(measure.replace("_", "-") for measure in MEASURES)
"""Stems of what is measured against object dataflow, whose own panel has nothing to show."""


def folder_figures(points: Points) -> Iterator[Figure]:
    """Each measure along the best axes; none where all points are of one folder."""
    if FOLDER not in points.axes:
        return
    for figure in profit_figures(ProfitData(points, lines=FOLDER)):
        plates = dict(figure.plates)
        if figure.stem.startswith(FLAT):
            flat = words.policy(REFERENCE)
            plates = {
                plate: [panel for panel in panels if panel.title != flat] or panels
                for plate, panels in plates.items()
            }
        yield replace(figure, stem=PREFIX + figure.stem, plates=plates)
