"""How well the mean of some draws is known: Student's interval (1908)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache
from statistics import fmean
from typing import NamedTuple

PLAIN = 0.95
"""Confidence, where the number of draws was not chosen by their values."""
MOST_LOGARITHM = 700.0
"""Few draws far apart have an end beyond what a float holds."""


class MeanInterval(NamedTuple):
    """A mean over draws, and its confidence interval; nan where it is not known."""

    mean: float
    low: float
    high: float

    @classmethod
    def unknown(cls, mean: float = math.nan) -> MeanInterval:
        """Draws that say nothing of how far others may be."""
        return cls(mean, math.nan, math.nan)


def interval(values: Sequence[float], confidence: float = PLAIN) -> tuple[float, float] | None:
    """The confidence interval of the mean of independent draws; None if they can't tell."""
    n, mean = len(values), fmean(values)
    if n < 2 or not math.isfinite(mean):
        return None
    half = half_width(values, confidence)
    return mean - half, mean + half


def of_logarithms(values: Sequence[float], confidence: float = PLAIN) -> MeanInterval:
    """Geometric mean and interval of positive draws: those of their logarithms.

    Ends are positive, and those of 1 / values are 1 / the ends. A draw of 0 or infinity makes the
    mean that, and no interval known; nan are those of no draws, or where both are among them.
    """
    if not values:
        return MeanInterval.unknown()
    if min(values) == max(values):  # else rounding would tell equal draws from their mean
        known = len(values) > 1 and 0 < values[0] < math.inf
        return MeanInterval(*(values[0],) * 3) if known else MeanInterval.unknown(values[0])
    logarithms = [math.log(value) if value else -math.inf for value in values]
    if not all(map(math.isfinite, logarithms)):
        return MeanInterval.unknown(math.exp(sum(logarithms)))
    mean, half = fmean(logarithms), half_width(logarithms, confidence)
    return MeanInterval(
        *(math.exp(min(x, MOST_LOGARITHM)) for x in (mean, mean - half, mean + half))
    )


def half_width(values: Sequence[float], confidence: float) -> float:
    """Half of the interval of at least two finite draws; 0 if all are equal."""
    n, mean = len(values), fmean(values)
    if min(values) == max(values):
        return 0.0
    deviation = math.sqrt(math.fsum((value - mean) ** 2 for value in values) / (n - 1))
    return quantile(n - 1, confidence) * deviation / math.sqrt(n)


@cache
def quantile(freedom: int, confidence: float) -> float:
    """Student's t that is exceeded on either side with probability (1 - confidence) / 2."""
    from scipy.special import stdtrit  # takes half a second

    return float(stdtrit(freedom, (1 + confidence) / 2))
