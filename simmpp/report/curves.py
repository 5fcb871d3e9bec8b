"""Curves with the spread of their seeds, beside what the paper states: what a figure is made of."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

from simmpp.report.measured import Ratios, mean


class Spread(NamedTuple):
    """A value over seeds."""

    mean: float
    low: float
    """The least of the seeds."""
    high: float
    """The largest of the seeds."""


@dataclass(frozen=True)
class Curve:
    """A line with a band around it; those with one label look the same."""

    label: str
    points: dict[float, Spread]
    """By abscissa."""
    is_guide: bool = False
    """Not measured: drawn thin and grey."""
    said: dict[float, str] = field(default_factory=dict)
    """What is written beside points, by abscissa."""
    floor: float = 0
    """Below this nothing can be told apart; drawn as a band under the curve."""


@dataclass(frozen=True)
class Stated:
    """A range that the paper's text gives, drawn behind the curves."""

    left: float
    right: float
    low: float
    high: float
    label: str


@dataclass(frozen=True)
class Scale:
    """An axis: what it shows and in which unit, and how it is divided."""

    label: str
    is_log: bool = False
    ticks: tuple[float, ...] = ()
    """Chosen by the plot if empty."""


@dataclass(frozen=True)
class Panel:
    """One system of axes."""

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


def curve(
    label: str, abscissas: Iterable[float], ratios_at: Callable[[float], Ratios], unit: float = 1
) -> Curve:
    """The curve of what was measured; ``unit`` scales the abscissa, 100 for per cent.

    Points without a result are left out.
    """
    measured = {x: ratios_at(x) for x in abscissas}
    spreads = {
        x * unit: Spread(mean(ratios), min(ratios), max(ratios))
        for x, ratios in measured.items()
        if ratios
    }
    return Curve(label, spreads)
