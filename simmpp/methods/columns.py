"""The columns of ``results.csv``, which every later step reads."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from simmpp.engine import columns, memory_use

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
FURTHER = tuple(name for names in BY_USE.values() for name in names)
TEXTS = (memory_use.REASON,)
"""Those of them that are no integers."""
COLUMNS = (*KEYS, METHOD, "engine", *NUMBERS, "error")


def result_columns(further: Sequence[str] = (), uses: Collection[str] = ()) -> tuple[str, ...]:
    """The columns of ``results.csv`` with those of a sweep's further keys, and of what it uses."""
    used = (name for use, names in BY_USE.items() if use in uses for name in names)
    return (*KEYS, *further, METHOD, "engine", *NUMBERS, *used, "error")
