"""Every figure of a report as PNG and SVG, for papers and slides."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

from simmpp.plot.curves import Bars, Panel
from simmpp.plot.matplotlib_panels import draw
from simmpp.report.page.figures.figure import Figure


def write_stills(figures: Iterable[Figure], folder: Path) -> Iterator[list[Path]]:
    """Write each plate of each figure; yields what was written."""
    folder.mkdir(parents=True, exist_ok=True)
    for figure in figures:
        for plate, panels in figure.plates.items():
            yield draw(
                [titled(panel, figure, plate) for panel in panels], folder / figure.files[plate]
            )


def titled(panel: Panel | Bars, figure: Figure, plate: str) -> Panel | Bars:
    """A title that says all, as the file stands alone."""
    if isinstance(panel, Panel) and panel.title.startswith("Figure"):
        return panel
    title = ": ".join(filter(None, (figure.title, ", ".join(filter(None, (plate, panel.title))))))
    return replace(panel, title=title)
