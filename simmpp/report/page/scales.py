"""Axes of a report: how the values of a key lie along one."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from statistics import geometric_mean
from typing import Any

from simmpp.common.units import SIZES
from simmpp.plot.curves import ON_EACH_PE, PERCENT, Scale
from simmpp.run import words

LOG_FROM = 8.0
"""Largest over least value from which an axis is better logarithmic."""
WIDE = 0.5
"""Fractions up to here at least are divided like the paper's axes."""


def label(name: str, cell: Any) -> str:
    """What stands at the tick of a value."""
    return words.policy(cell) if name == "policy" else words.bare(name, cell)


def abscissa(name: str, values: list[Any]) -> tuple[Scale, dict[Any, float]]:
    """The axis of a key, and where on it each of its values lies; texts lie side by side."""
    if not all(map(words.is_number, values)):
        places = {cell: float(n) for n, cell in enumerate(values)}
        names = tuple(label(name, cell) for cell in values)
        title = name if name not in ("policy", "scene") else ""
        return Scale(title, ticks=(*places.values(),), names=names), places
    if name == "fraction":
        wide = max(values) >= WIDE
        scale = ON_EACH_PE if wide else Scale(ON_EACH_PE.label)
        return scale, {share: share * PERCENT for share in values}
    places = {number: float(number) for number in values}
    if name == "processors":
        ticks = (*places.values(),)
        return Scale("processing elements (PEs)", is_log=True, ticks=ticks), places
    if name == words.CAPACITY:
        unit, size = unit_of(SIZES, values)
        places = {number: number / size for number in values}
        return Scale(f"memory of a PE ({unit})", is_log=is_log(values)), places
    unit = words.unit_of(name)
    return Scale(f"{name} ({unit})" if unit else name, is_log=is_log(values)), places


def unit_of(units: Sequence[tuple[str, int]], values: Iterable[float]) -> tuple[str, int]:
    """The unit in which typical values have few digits; none, and 1, without units."""
    if not units:
        return "", 1
    positive = [value for value in values if value > 0]
    typical = geometric_mean(positive) if positive else 0.0
    return next((unit for unit in units if typical >= unit[1]), units[-1])


def is_log(values: Iterable[float]) -> bool:
    """Whether values are better shown on a logarithmic axis."""
    finite = [number for number in values if math.isfinite(number)]
    return bool(finite) and min(finite) > 0 and max(finite) > LOG_FROM * min(finite)
