"""How a report calls keys, points and ratios."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

from simmpp.plot.curves import ON_EACH_PE, PERCENT, Scale

PAPER_WORDS = {
    "object": "object dataflow",
    "ray": "ray dataflow",
    "concurrent": "concurrent dataflow",
    "replicated": "replicated scene",
}
"""Policies in the paper's words; a label of the user stays as it is."""
ALONG = {"fraction": "the fraction of the scene", "processors": "the number of PEs"}
SHORT = {"fraction": "x", "processors": "PEs"}
LOG_FROM = 8.0
"""Largest over least value from which an axis is better logarithmic."""
WIDE = 0.5
"""Fractions up to here at least are divided like the paper's axes."""


def policy(title: str) -> str:
    """A policy as the paper calls it: ``"ray"`` -> ``"ray dataflow"``."""
    return PAPER_WORDS.get(title, title)


def value(name: str, cell: Any) -> str:
    """A key's value, alone: ``"5 %"``, ``"64"``, ``"mountain:5"``."""
    if cell == "":
        return "none"
    if name == "fraction":
        return f"{cell * PERCENT:.3g} %"
    return f"{cell:g}" if isinstance(cell, float) else str(cell)


def label(name: str, cell: Any) -> str:
    """What stands at the tick of a value."""
    return policy(cell) if name == "policy" else value(name, cell).removesuffix(" %")


def said(name: str, cell: Any) -> str:
    """A key and its value: ``"x = 5 %"``, ``"64 PEs"``, ``"mountain:5"``."""
    if name == "scene":
        return str(cell)
    if name == "processors":
        return f"{cell} PEs" if cell != 1 else "1 PE"
    if name == "fraction":
        return "memory in bytes" if cell == "" else f"x = {value(name, cell)}"
    return policy(cell) if name == "policy" else f"{name} {value(name, cell)}"


def point(keys: Mapping[str, Any], names: Iterable[str]) -> str:
    """Several of them: ``"mountain:5, 64 PEs, x = 5 %"``."""
    return ", ".join(said(name, keys[name]) for name in names)


def abscissa(name: str, values: list[Any]) -> tuple[Scale, dict[Any, float]]:
    """The axis of a key, and where on it each of its values lies; texts lie side by side."""
    if not all(map(is_number, values)):
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
    return Scale(name, is_log=is_log(values)), places


def is_number(cell: Any) -> bool:
    """It is a number, and not a text that a key has in place of one."""
    return isinstance(cell, int | float)


def is_log(values: Iterable[float]) -> bool:
    """Whether values are better shown on a logarithmic axis."""
    finite = [number for number in values if math.isfinite(number)]
    return bool(finite) and min(finite) > 0 and max(finite) > LOG_FROM * min(finite)


def is_finite(cell: Any) -> bool:
    """It is a number below infinity."""
    return is_number(cell) and math.isfinite(cell)


def capital(text: str) -> str:
    """The first letter large, the others as they are."""
    return text[:1].upper() + text[1:]
