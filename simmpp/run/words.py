"""How sentences and tables call policies, keys, points and ranges."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

from simmpp.common.units import format_bytes
from simmpp.config.keys import keys

PAPER_WORDS = {
    "object": "object dataflow",
    "ray": "ray dataflow",
    "concurrent": "concurrent dataflow",
    "replicated": "replicated scene",
    "holders": "dataflow to all holders",
    "cost": "dataflow by estimated costs",
}
"""Policies in the paper's words; a label of the user stays as it is."""
OF_PARTICLES = {
    "object": "cell (or mesh) passing",
    "ray": "particle passing",
    "replicated": "replication",
}
"""What they are called where cells are the objects and particles the rays (Branson, LANL)."""
CAPACITY, UNBOUNDED = "memory.capacity", "none"
"""The key whose values are bytes, and its value where memory has no end."""
ALONG = {
    "fraction": "the fraction of the scene",
    "processors": "the number of PEs",
    CAPACITY: "the memory of a PE",
}
ACTIONS = {
    "object": "Fetch the objects",
    "ray": "Send the rays",
    "concurrent": "Let each node choose",
    "replicated": "Hold everything everywhere",
    "holders": "Let each node choose among all that hold the object",
    "cost": "Let each node choose by what either is estimated to cost",
}
"""What one does who follows a policy, for those who have not read the paper."""
SHORT = {"fraction": "x", "processors": "PEs"}
CAUSES = {
    "scene": "the scene",
    "processors": "the number of PEs",
    "fraction": "the memory",
    CAPACITY: "the capacity",
    "folder": "the folder",
}
"""Keys as what decides."""
CLOSE = 1.1
"""Ratios up to here are told as percentages."""


def policy(title: str) -> str:
    """A policy as the paper calls it: ``"ray"`` -> ``"ray dataflow"``."""
    return PAPER_WORDS.get(title, title)


def value(name: str, cell: Any) -> str:
    """A key's value, alone: ``"5 %"``, ``"64"``, ``"mountain:5"``, ``"16 tests"``."""
    unit = "" if isinstance(cell, str) or name == "processors" else unit_of(name)
    return " ".join(filter(None, (bare(name, cell), unit)))


def bare(name: str, cell: Any) -> str:
    """The same without its unit."""
    if cell == "":
        return "none"
    if name == "fraction":
        return f"{cell * 100:.3g}"
    if name == CAPACITY:
        return format_bytes(cell) if is_number(cell) else cell.replace(UNBOUNDED, "unbounded")
    return f"{cell:g}" if isinstance(cell, float) else str(cell)


def unit_of(name: str) -> str:
    """What a key counts; nothing for those that have their units in their values."""
    if name == "fraction":
        return "%"
    unit = keys()[name].expect.unit if name in keys() else ""
    return "" if " or " in unit else unit


def said(name: str, cell: Any) -> str:
    """A key and its value: ``"x = 5 %"``, ``"64 PEs"``, ``"mountain:5"``."""
    if name == "scene":
        return str(cell)
    if name == "processors":
        return f"{cell} PEs" if cell != 1 else "1 PE"
    if name == "fraction":
        return "memory in bytes" if cell == "" else f"x = {value(name, cell)}"
    if name == CAPACITY:
        return "unbounded memory" if cell == UNBOUNDED else f"{value(name, cell)} per PE"
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


def uncapital(text: str) -> str:
    """The first letter small, the others as they are."""
    return text[:1].lower() + text[1:]


def span(values: Iterable[float]) -> str:
    """``"1.3 to 1.71"``; one number where all are the same."""
    ordered = sorted(value for value in values if is_number(value))
    if not ordered:
        return ""
    low, high = f"{ordered[0]:.3g}", f"{ordered[-1]:.3g}"
    return low if low == high or math.isnan(ordered[0]) else f"{low} to {high}"


def values(name: str, cells: list[Any]) -> str:
    """``"8 and 64 PEs"``, ``"memory for 5 % and 10 % of the scene"``, ``"rings:2 and tetra:4"``."""
    if name == "scene" or "" in cells:
        return any_of((said(name, cell) for cell in cells), "and")
    return _framed(name, any_of((value(name, cell) for cell in cells), "and"))


def between(name: str, low: Any, high: Any) -> str:
    """``"4 to 64 PEs"``, ``"memory for 5 % to 100 % of the scene"``."""
    return _framed(name, f"{value(name, low)} to {value(name, high)}")


def up_to(name: str, high: Any) -> str:
    """``"up to 64 PEs"``, ``"memory for up to 5 % of the scene"``."""
    return _framed(name, f"up to {value(name, high)}")


def from_on(name: str, low: Any) -> str:
    """``"at least 64 PEs"``, ``"memory for at least 5 % of the scene"``."""
    return _framed(name, f"at least {value(name, low)}")


def _framed(name: str, text: str) -> str:
    """Values of a key with what they are of, for those who don't know its name."""
    if name == "processors":
        return f"{text} PE" if text == "1" else f"{text} PEs"
    if name == CAPACITY:
        return f"memory per PE {text}"
    return f"memory for {text} of the scene" if name == "fraction" else f"{name} {text}"


def times_as_long(ratios: Iterable[float]) -> str:
    """``"1.2 to 480 times as long"``, ``"0.4 % to 3.2 % longer"`` where that says more."""
    ordered = sorted(ratio for ratio in ratios if is_number(ratio) and not math.isnan(ratio))
    if not ordered:
        return ""
    low, high = ordered[0], ordered[-1]
    if low >= 1 and high < CLOSE:
        return f"{span((ratio - 1) * 100 for ratio in ordered)} % longer"
    if 1 <= low < CLOSE:
        return f"{(low - 1) * 100:.2g} % longer to {high:.2g} times as long"
    return f"{span(ordered)} times as long"


def any_of(names: Iterable[str], joint: str = "or") -> str:
    """``"a, b or c"``; each once."""
    *first, last = dict.fromkeys(names)
    return f"{', '.join(first)} {joint} {last}" if first else last
