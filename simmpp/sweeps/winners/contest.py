"""Who is fastest at one place of a sweep, by how much, and whether its seeds can tell.

Policies share the draws of a seed, so they are compared seed by seed. The interval is Student's
(1908) of the ratios of makespans.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import fmean

from simmpp.policy.parameters import CEILING
from simmpp.run.profit import ratio
from simmpp.run.rows import pairs
from simmpp.sweeps.intervals import interval
from simmpp.sweeps.winners.points import Points

SURE, UNSURE, EQUAL, ALONE, TOO_FEW_SEEDS = "sure", "unsure", "equal", "alone", "too few seeds"
"""Beyond the interval, within it, the same in all seeds, without others, without an interval."""


@dataclass(frozen=True)
class Contest:
    """The two fastest dataflows at one place."""

    best: int
    """Number of the fastest point."""
    second: int | None
    """Of the next."""
    lead: float
    """T(second) / T(best): the mean of the seeds' own ratios; nan without common ones."""
    low: float
    high: float
    """Its 95 % interval."""
    certainty: str
    ceiling: float | None
    """T(best) / T(replicated), likewise; None where the replicated scene was not run."""


def contests_of(points: Points) -> list[Contest]:
    """One for each place where a dataflow has a result."""
    replicated = replicated_policies(points)
    contests = []
    for place in points.places:
        ran = [n for n in place if points.runs[n]]
        flows = [n for n in ran if points.profits[n]["policy"] not in replicated]
        ceilings = [n for n in ran if points.profits[n]["policy"] in replicated]
        if flows:
            contests.append(_contest(points, flows, ceilings))
    return contests


def replicated_policies(points: Points) -> set[str]:
    """Policies that are no dataflow: the whole scene is in every memory, whatever the fraction."""
    scarce = [n for n, row in enumerate(points.profits) if row["fraction"] != 1]
    titles = {points.profits[n]["policy"] for n in scarce if points.runs[n]}
    for number in scarce:
        if any(row["effective_fraction"] < 1 for row in points.runs[number]):
            titles.discard(points.profits[number]["policy"])
    return titles | {CEILING}


def _contest(points: Points, flows: list[int], ceilings: list[int]) -> Contest:
    times = means(points, flows)
    ranked = sorted(flows, key=lambda n: times[n])
    best, second = ranked[0], ranked[1] if len(ranked) > 1 else None
    ratios = makespan_ratios(points, second, best) if second is not None else []
    low, high = (interval(ratios) if ratios else None) or (math.nan, math.nan)
    top = makespan_ratios(points, best, ceilings[0]) if ceilings else []
    return Contest(
        best,
        second,
        fmean(ratios) if ratios else math.nan,
        low,
        high,
        ALONE if second is None else _certainty(ratios, low),
        fmean(top) if top else None,
    )


def means(points: Points, flows: list[int]) -> dict[int, float]:
    """Mean makespans (ps) over the seeds that all have, or each its own where there are none."""
    seeds = [set(points.seeds[n]) for n in flows]
    common = set.intersection(*seeds) or set.union(*seeds)
    return {
        n: fmean(row["makespan_ps"] for row in points.runs[n] if row["seed"] in common)
        for n in flows
    }


def makespan_ratios(points: Points, above: int, below: int) -> list[float]:
    """T(above) / T(below) for each seed that both have."""
    both = pairs(points.seeds[above], points.seeds[below])
    return [ratio(upper["makespan_ps"], lower["makespan_ps"]) for upper, lower in both]


def _certainty(ratios: list[float], low: float) -> str:
    if ratios and all(value == 1 for value in ratios):
        return EQUAL
    if math.isnan(low):
        return TOO_FEW_SEEDS
    return SURE if low > 1 else UNSURE
