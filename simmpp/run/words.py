"""How sentences and tables call policies, keys, points and ranges."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

PAPER_WORDS = {
    "object": "object dataflow",
    "ray": "ray dataflow",
    "concurrent": "concurrent dataflow",
    "replicated": "replicated scene",
}
"""Policies in the paper's words; a label of the user stays as it is."""
ALONG = {"fraction": "the fraction of the scene", "processors": "the number of PEs"}
SHORT = {"fraction": "x", "processors": "PEs"}


def policy(title: str) -> str:
    """A policy as the paper calls it: ``"ray"`` -> ``"ray dataflow"``."""
    return PAPER_WORDS.get(title, title)


def value(name: str, cell: Any) -> str:
    """A key's value, alone: ``"5 %"``, ``"64"``, ``"mountain:5"``."""
    if cell == "":
        return "none"
    if name == "fraction":
        return f"{cell * 100:.3g} %"
    return f"{cell:g}" if isinstance(cell, float) else str(cell)


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


def is_number(cell: Any) -> bool:
    """It is a number, and not a text that a key has in place of one."""
    return isinstance(cell, int | float)


def is_finite(cell: Any) -> bool:
    """It is a number below infinity."""
    return is_number(cell) and math.isfinite(cell)


def capital(text: str) -> str:
    """The first letter large, the others as they are."""
    return text[:1].upper() + text[1:]


def span(values: Iterable[float]) -> str:
    """``"1.3 to 1.71"``; one number where all are the same."""
    ordered = sorted(value for value in values if is_number(value))
    if not ordered:
        return ""
    low, high = f"{ordered[0]:.3g}", f"{ordered[-1]:.3g}"
    return low if low == high or math.isnan(ordered[0]) else f"{low} to {high}"
