"""Every figure of a report as PNG and SVG, for papers and slides."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

from simmpp.report.bars import Bars
from simmpp.report.curves import Panel
from simmpp.report.page.figure import Figure
from simmpp.report.panels import draw


def write_stills(figures: Iterable[Figure], folder: Path) -> Iterator[list[Path]]:
    """Write each plate of each figure; what was written is told one by one."""
    folder.mkdir(parents=True, exist_ok=True)
    for figure in figures:
        for plate, panels in figure.plates.items():
            titled = [_titled(panel, figure, plate) for panel in panels]
            yield draw(titled, folder / figure.files[plate])


def _titled(panel: Panel | Bars, figure: Figure, plate: str) -> Panel | Bars:
    """A title that says all, as the file stands alone."""
    if isinstance(panel, Panel) and panel.title.startswith("Figure"):
        return panel
    title = ": ".join(filter(None, (figure.title, ", ".join(filter(None, (plate, panel.title))))))
    return replace(panel, title=title)
