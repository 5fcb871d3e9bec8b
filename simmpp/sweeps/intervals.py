"""How well the mean of some draws is known: Student's interval (1908)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import fmean


def interval(values: Sequence[float], confidence: float = 0.95) -> tuple[float, float] | None:
    """The confidence interval of the mean of independent draws; None if they can't tell."""
    n, mean = len(values), fmean(values)
    if n < 2 or not math.isfinite(mean):
        return None
    half = half_width(values, confidence)
    return mean - half, mean + half


def half_width(values: Sequence[float], confidence: float) -> float:
    """Half of the interval of at least two finite draws; 0 if all are equal."""
    n, mean = len(values), fmean(values)
    if min(values) == max(values):
        return 0.0
    deviation = math.sqrt(math.fsum((value - mean) ** 2 for value in values) / (n - 1))
    return quantile(n - 1, confidence) * deviation / math.sqrt(n)


def quantile(freedom: int, confidence: float) -> float:
    """Student's t that is exceeded on either side with probability (1 - confidence) / 2."""
    from scipy.special import stdtrit  # takes half a second

    return float(stdtrit(freedom, (1 + confidence) / 2))
