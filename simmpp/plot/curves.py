"""Figures as data: panels of curves with the spread of their seeds, or of stacked bars."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

LOG_MARGIN = 1.2
"""Factor of room beyond both ends of a logarithmic axis."""

PART_COLOURS = {
    "compute": 0,
    "launches": 7,
    "communication": 1,
    "reductions": 7,
    "startups": 1,
    "copying": 4,
    "one hot PE": 5,
    "imbalance": 3,
    "barriers": 6,
    "latency": 2,
    "bandwidth": 6,
    "waiting": 2,
    "objects for good": 0,
    "fetched objects": 1,
    "rays received": 2,
    "requests": 0,
    "objects": 1,
    "rays": 3,
    "loads": 2,
}
"""Number of the colour of each part of a bar."""


class Spread(NamedTuple):
    """A mean over seeds, and how far these, or its interval, reach."""

    mean: float
    low: float
    """The least of the seeds, or the lower end of an interval: the panel's note says which."""
    high: float
    """The largest of the seeds, or the upper end."""


@dataclass(frozen=True)
class Curve:
    """A line with a band around it; those with one label look the same."""

    label: str
    points: dict[float, Spread]
    """By abscissa."""
    is_guide: bool = False
    """Not measured: drawn thin and grey."""
    notes: dict[float, str] = field(default_factory=dict)
    """What is written beside points, by abscissa."""
    floor: float = 0
    """Below this nothing can be told apart; drawn as a band under the curve."""
    style: int | None = None
    """Number of its colour and marker; its place among the panel's curves if not given."""
    rows: dict[float, int] = field(default_factory=dict)
    """Number of the profit that a point shows, by abscissa, where there is one."""
    is_before: bool = False
    """What another curve is compared with: drawn wide and pale."""
    marked: frozenset[float] = frozenset()
    """Abscissas of points that are to be looked at."""


@dataclass(frozen=True)
class Stated:
    """A range that the paper's text gives, drawn behind the curves."""

    left: float
    right: float
    low: float
    high: float
    label: str


@dataclass(frozen=True)
class Hatched:
    """A range without points of a curve, for a reason: a hatched strip of its colour."""

    left: float
    right: float
    low: float
    high: float
    label: str
    """The curve's, or what the strip is called where there is none."""
    style: int


@dataclass(frozen=True)
class Scale:
    """An axis: what it shows and in which unit, and how it is divided."""

    label: str
    is_log: bool = False
    ticks: tuple[float, ...] = ()
    """Chosen by the plot if empty."""
    names: tuple[str, ...] = ()
    """What stands at the ticks, if not their numbers; values in between mean nothing."""
    limits: tuple[float, float] | None = None
    """Its ends, where panels are to be compared; chosen by the plot if not given."""


PERCENT = 100
ON_EACH_PE = Scale("objects resident on each PE (% of the scene)", ticks=(0, 20, 40, 60, 80, 100))
"""The paper's axis of the fraction x."""


@dataclass(frozen=True)
class Panel:
    """One system of axes with curves in it."""

    title: str
    x: Scale
    y: Scale
    curves: list[Curve]
    stated: list[Stated] = field(default_factory=list)
    level: float | None = None
    """A value that divides winners from losers, drawn as a thin line."""
    note: str = ""
    """What lines and bands are."""
    legend: str = ""
    """What the curves' labels are, if that needs saying."""
    hatched: list[Hatched] = field(default_factory=list)

    def style_of(self, curve: Curve) -> int:
        """Number of a measured curve's colour and marker: those of one label look the same."""
        if curve.style is not None:
            return curve.style
        labels = dict.fromkeys(curve.label for curve in self.curves if not curve.is_guide)
        return list(labels).index(curve.label)

    @property
    def has_bands(self) -> bool:
        """Spreads are drawn as bands: not between names, and not over what was before."""
        return not self.x.names and not any(curve.is_before for curve in self.curves)


@dataclass(frozen=True)
class Bars:
    """One system of axes with stacked bars side by side: what a whole is made of."""

    title: str
    x: Scale
    """Its names are those of the bars."""
    y: Scale
    parts: dict[str, list[float]]
    """Heights of each part, one for each bar; the bottom part first."""
    rows: list[int] = field(default_factory=list)
    """Number of the point that a bar shows."""


class Tile(NamedTuple):
    """A place of a map."""

    x: int
    """Number of its name on the axis."""
    y: int
    row: int
    """Number of the point that it shows."""
    text: str
    """What is said of it."""


TILE = 0.94
"""Width and height of tiles, whose places are 1 apart."""


@dataclass(frozen=True)
class Layer:
    """The tiles of a map that have one thing in common."""

    label: str
    style: int | None
    """Number of its colour; hatched without one."""
    tiles: list[Tile]


@dataclass(frozen=True)
class Tiles:
    """A map over two axes of names, of coloured tiles."""

    title: str
    x: Scale
    y: Scale
    layers: list[Layer]


Drawable = Panel | Bars | Tiles
