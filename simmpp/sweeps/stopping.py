"""How many seeds a point needs until its profits are known within a tolerance.

Seeds are taken in a fixed order and the decision depends on nothing but the values of the seeds
taken so far, so a point has the same seeds whoever simulates it, in whatever order.

*Looks.* After n seeds every profit has a half-width h, relative to its mean. If all are within the
tolerance the point is finished; else the next look is after n (h / tolerance)^2 seeds of the widest
profit, which is what a fixed number would need if its deviation were known, and after 2 n at most,
for the deviation isn't. So most points have two or three looks, and the seeds between two can
be run at the same time (Hall 1983, Sequential estimation saving sampling operations, J. R. Statist.
Soc. B 45, 219-223).

*Correction.* A point that stops as soon as its interval is narrow stops too often where its
deviation happens to be underestimated, so an interval of 95 % would hold less often: with a normal
distribution 92 to 94 % where 10 to 50 seeds are needed (Starr 1966, Ann. Math. Statist. 37, 36-50;
asymptotically nothing is lost: Chow and Robbins 1965, same journal 36, 457-462), and less with a
skewed one. So half of the 5 % is left to stopping and to skewness: quantiles of t are those of
97.5 %, both when deciding and in the interval reported.

*No spread.* Draws that are all equal say nothing of how far apart the next ones are. Their interval
is as wide as the tolerance, unless there was nothing to draw.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from fractions import Fraction
from itertools import chain, islice
from statistics import fmean
from typing import TYPE_CHECKING

from simmpp.common.validate import MOST_SEED
from simmpp.sweeps.intervals import half_width, interval

if TYPE_CHECKING:
    from simmpp.config.settings import Settings

FEWEST = 8
"""Seeds before the first look."""
CORRECTED = 0.975
"""Confidence of the quantiles, so that intervals hold 95 % of the time."""
GROWTH = 2
"""From one look to the next there are at most that many times as many seeds."""


def seeds_in_order(given: Sequence[int], count: int) -> list[int]:
    """The first ``count`` seeds: those given, then the integers that follow the last of them."""
    taken = set(given)
    all_seeds = chain(range(given[-1] + 1, MOST_SEED + 1), range(MOST_SEED + 1))
    following = (seed for seed in all_seeds if seed not in taken)
    return list(islice(chain(given, following), count))


def first_seeds(settings: Settings) -> list[int]:
    """The seeds that every point has."""
    least = 1 if settings.tolerance is None else FEWEST
    return seeds_in_order(settings.seeds, max(least, len(settings.seeds)))


def seeds_wanted(
    profits: Iterable[Sequence[float]], seeds: int, tolerance: Fraction, most: int
) -> int:
    """After how many seeds to look next; ``seeds``, their present number, if that is enough.

    ``profits`` holds, for each policy and measure, the values of the seeds.
    """
    widest = max((_relative_half_width(values) for values in profits), default=0.0)
    if widest <= tolerance:
        return seeds
    # at most GROWTH times as many, for a deviation of eight seeds is itself known to a quarter only
    needed = math.ceil(min(GROWTH, (widest / float(tolerance)) ** 2) * seeds)
    return min(max(needed, seeds + 1), max(most, seeds))


def _relative_half_width(values: Sequence[float]) -> float:
    """Half-width over mean; 0 where more draws would not help, and of what has no result."""
    mean = fmean(values) if values else 0.0
    return half_width(values, CORRECTED) / mean if math.isfinite(mean) and mean else 0.0


def corrected_interval(
    values: Sequence[float], tolerance: Fraction, is_drawn: bool
) -> tuple[float, float] | None:
    """The interval of a profit whose number of seeds was chosen by its values."""
    bounds = interval(values, CORRECTED)
    if bounds and is_drawn and min(values) == max(values):
        # equal by luck: an interval of no width would be a lie
        mean = fmean(values)
        half = float(tolerance) * mean
        return mean - half, mean + half
    return bounds
