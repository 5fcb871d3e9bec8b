"""What a whole is made of, as stacked bars: shares of time, messages by kind."""

from __future__ import annotations

from dataclasses import dataclass, field

from simmpp.report.curves import Scale


@dataclass(frozen=True)
class Bars:
    """One system of axes with bars side by side."""

    title: str
    x: Scale
    """Its names are those of the bars."""
    y: Scale
    parts: dict[str, list[float]]
    """Heights of each part, one for each bar; the bottom part first."""
    rows: list[int] = field(default_factory=list)
    """Number of the point that a bar shows."""
