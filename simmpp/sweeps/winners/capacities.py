"""The capacity of a PE's memory as an axis: bytes, so that it has an order; texts have none."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress

from simmpp.common.errors import ConfigError
from simmpp.common.files import Row
from simmpp.common.units import byte_count
from simmpp.run.words import CAPACITY, UNBOUNDED

_WRITTEN_UNBOUNDED = ("none", "null")
"""As rows have it, by what the configuration says."""


def in_bytes(rows: Sequence[Row]) -> list[Row]:
    """Rows with a swept capacity as a number; ``least`` and UNBOUNDED stay words."""
    if not rows or CAPACITY not in rows[0]:
        return list(rows)
    return [row | {CAPACITY: _bytes(row[CAPACITY])} for row in rows]


def _bytes(cell: object) -> object:
    if cell in _WRITTEN_UNBOUNDED:
        return UNBOUNDED
    with suppress(ConfigError):
        return byte_count(cell)
    return cell
