"""The columns of ``results.csv``, which every later step reads."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any

from simmpp.engine import columns, memory_use
from simmpp.engine.tables import residuals

PLACE = ("scene", "processors", "fraction")
"""What names a point but its policy, with the columns that only a sweep changes."""
KEYS = (*PLACE, "effective_fraction", "policy", "seed")
METHOD = "method"
"""A key as well where a sweep changes it."""
NUMBERS = columns.COLUMNS
"""Integers of a run; empty where the method does not know."""
BOUNDED = "bounded"
"""The memory of PEs has a capacity."""
BY_USE = {
    "packs": columns.PACKED_COLUMNS,
    "talks": columns.USER_COLUMNS,
    "steals": columns.STEAL_COLUMNS,
    "threads": columns.SERVICE_COLUMNS,
    "is uneven": columns.UNEVEN_COLUMNS,
    BOUNDED: (*memory_use.COLUMNS, memory_use.REASON),
}
"""Further ones, of sweeps in which a point makes use of something (``PolicyParameters.uses``,
``Machine.uses``)."""
BY_ROWS = {
    "rounds": columns.ROUND_COLUMNS,
    "tallies": columns.TALLY_COLUMNS,
    "residuals": tuple(residuals.LEFT),
}
"""Likewise, of sweeps in which the first of them is above 0 in a row: only rays tell."""
FURTHER = tuple(name for names in (*BY_USE.values(), *BY_ROWS.values()) for name in names)
TEXTS = (memory_use.REASON,)
"""Those of them that are no integers."""
COLUMNS = (*KEYS, METHOD, "engine", *NUMBERS, "error")


def told_by(rows: Iterable[Mapping[str, Any]]) -> set[str]:
    """What rows make use of, as rays told."""
    rows = list(rows)
    return {use for use, names in BY_ROWS.items() if any(row.get(names[0]) for row in rows)}


def result_columns(further: Sequence[str] = (), uses: Collection[str] = ()) -> tuple[str, ...]:
    """The columns of ``results.csv`` with those of a sweep's further keys, and of what it uses."""
    used = (n for use, names in (BY_USE | BY_ROWS).items() if use in uses for n in names)
    return (*KEYS, *further, METHOD, "engine", *NUMBERS, *used, "error")
