"""A figure: panels that belong together, on one or several plates of which one is looked at."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from simmpp.common.files import Row
from simmpp.plot.curves import Bars, Drawable, Tiles
from simmpp.plot.plotly_panels import drawn
from simmpp.run import words


@dataclass(frozen=True)
class Figure:
    """Plates of panels under one title; the page shows, and a file holds, one plate at once."""

    stem: str
    """Of its files, and its name in the page."""
    title: str
    note: str
    plates: Mapping[str, Sequence[Drawable]]
    """By what they are of; the empty text if there is only one."""
    is_folded: bool = False
    """Shown when it is asked for."""

    @property
    def first(self) -> int:
        """Number of the plate that shows most, which is looked at first."""
        sizes = [sum(map(_size, panels)) for panels in self.plates.values()]
        return sizes.index(max(sizes)) if sizes else 0

    @property
    def files(self) -> dict[str, str]:
        """The stem of each plate's files."""
        stems: dict[str, str] = {}
        for plate in self.plates:
            stem = "-".join(filter(None, (self.stem, slug(plate))))
            # Plates such as "a b" and "a-b" have one slug; their files must not be one.
            stems[plate] = stem if stem not in stems.values() else f"{stem}-{len(stems)}"
        return stems


def _size(panel: Drawable) -> int:
    """Points, bars or tiles of a panel."""
    if isinstance(panel, Tiles):
        return sum(len(layer.tiles) for layer in panel.layers)
    if isinstance(panel, Bars):
        return len(panel.rows)
    return sum(len(curve.points) for curve in panel.curves)


def slug(text: str) -> str:
    """``"x = 5 %, 64 PEs"`` -> ``"x-5-64-pes"``: safe in any file system."""
    return re.sub("[^a-z0-9.]+", "-", text.lower()).strip("-.")[:80]


def figure_data(figure: Figure) -> dict[str, Any]:
    """A figure's plates as plotly draws them."""
    plates = []
    for panels in figure.plates.values():
        title = next((t for t in (getattr(panel, "legend", "") for panel in panels) if t), "")
        drawings = [drawn(panel) for panel in panels]
        if len(drawings) == 1:
            drawings[0]["title"] = ""  # the figure has it
        plates.append({"title": title, "panels": drawings})
    return {"plates": plates}


def styles_of(rows: Iterable[Row], column: str = "policy") -> dict[str, int]:
    """A number for the colour of each policy, the same in all figures; the paper's come first.

    Likewise of what else a ``column`` holds.
    """
    titles = {row[column] for row in rows}
    others = sorted(titles - words.PAPER_WORDS.keys())
    return {title: n for n, title in enumerate([*words.PAPER_WORDS, *others]) if title in titles}
