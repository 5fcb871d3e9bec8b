"""Which profits of a sweep with a tolerance are known that well, and which are not."""

from __future__ import annotations

import math
from collections.abc import Iterable
from fractions import Fraction
from typing import NamedTuple

from simmpp.sweeps.profits import MEASURES
from simmpp.sweeps.tables import Row

ROUNDING = 1e-9
"""A half-width that is exactly the tolerance may be rounded to more."""


class Missed(NamedTuple):
    """A profit whose interval is wider than the tolerance."""

    row: Row
    """Of ``profits.csv``."""
    measure: str
    half_width: float
    """Of the interval, relative to the mean."""


def missed(profits: Iterable[Row], tolerance: Fraction) -> list[Missed]:
    """Profits that all the seeds there may be have not made known within the tolerance."""
    found = [
        Missed(row, measure, (row[f"{measure}_high"] - row[f"{measure}_low"]) / 2 / row[measure])
        for row in profits
        for measure in MEASURES
        if all(_is_number(row[name]) for name in (measure, f"{measure}_low")) and row[measure]
    ]
    return [each for each in found if each.half_width > float(tolerance) * (1 + ROUNDING)]


def _is_number(cell: object) -> bool:
    return isinstance(cell, float) and math.isfinite(cell)
