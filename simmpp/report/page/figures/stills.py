"""Figures of a report as PNG and SVG, for papers and slides: those that are asked for."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import as_completed
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from simmpp.common.errors import ConfigError
from simmpp.common.modules import PANELS
from simmpp.plot.curves import Drawable, Panel
from simmpp.report.page.figures.figure import Figure
from simmpp.sweeps.executors import processes

ALL = "all"
"""Stands for every figure."""


class Still(NamedTuple):
    """One plate of a figure, as it is drawn."""

    stem: str
    """Of its files."""
    panels: list[Drawable]


def stills_of(figures: Sequence[Figure], names: Sequence[str]) -> list[Still]:
    """The plates that names mean: all of a figure, or one by the stem of its files.

    Raises ConfigError, one line, for what there is not.
    """
    known = {ALL} | {name for figure in figures for name in (figure.stem, *figure.files.values())}
    if unknown := [name for name in dict.fromkeys(names) if name not in known]:
        there = ", ".join((ALL, *(figure.stem for figure in figures)))
        values = "value" if len(unknown) == 1 else "values"
        raise ConfigError(f"--figures: {values} {', '.join(map(repr, unknown))}: expected {there}")
    return [
        Still(stem, [titled(panel, figure, plate) for panel in figure.plates[plate]])
        for figure in figures
        for plate, stem in figure.files.items()
        if {ALL, figure.stem, stem} & set(names)
    ]


def write_stills(stills: Iterable[Still], folder: Path, workers: int) -> Iterator[list[Path]]:
    """Draw in so many processes; yields what was written, in the order of getting ready."""
    folder.mkdir(parents=True, exist_ok=True)
    with processes(workers, PANELS) as executor:
        drawings = [executor.submit(_draw, still.panels, folder / still.stem) for still in stills]
        for drawing in as_completed(drawings):
            yield drawing.result()


def _draw(panels: Sequence[Drawable], stem: Path) -> list[Path]:
    # Only who draws loads matplotlib, which takes half a second.
    from simmpp.plot.matplotlib_panels import draw

    return draw(panels, stem)


def titled(panel: Drawable, figure: Figure, plate: str) -> Drawable:
    """A title that says all, as the file stands alone."""
    if isinstance(panel, Panel) and panel.title.startswith("Figure"):
        return panel
    title = ": ".join(filter(None, (figure.title, ", ".join(filter(None, (plate, panel.title))))))
    return replace(panel, title=title)
