"""The columns of ``results.csv``, which every later step reads."""

from __future__ import annotations

from collections.abc import Sequence

from simmpp.engine import result

PLACE = ("scene", "processors", "fraction")
"""What names a point but its policy, with the columns that only a sweep changes."""
KEYS = (*PLACE, "effective_fraction", "policy", "seed")
METHOD = "method"
"""A key as well where a sweep changes it."""
NUMBERS = result.COLUMNS
"""Integers of a run; empty where the method does not know."""
PACKED = result.PACKED_COLUMNS
"""Further ones, of sweeps in which a policy packs."""
SERVED = result.SERVICE_COLUMNS
"""Likewise, of machines whose threads serve."""
COLUMNS = (*KEYS, METHOD, "engine", *NUMBERS, "error")


def result_columns(
    further: Sequence[str] = (), *, packs: bool = False, threads: bool = False
) -> tuple[str, ...]:
    """The columns of ``results.csv`` with those of a sweep's further keys."""
    numbers = (*NUMBERS, *(PACKED if packs else ()), *(SERVED if threads else ()))
    return (*KEYS, *further, METHOD, "engine", *numbers, "error")
