"""Who is fastest in one case of a sweep, by how much, and whether its seeds can tell.

A *case* is a place of the sweep: all that a point has but its policy; places with the same
simulations are one. Policies share the draws of a
seed, so they are compared seed by seed. Times differ by factors, so means and intervals are those
of the logarithms: the geometric mean, which has the same winner whichever way ratios are taken, and
Student's interval (1908).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean

from simmpp.policy.parameters import CEILING
from simmpp.run.profit import ratio
from simmpp.run.rows import pairs
from simmpp.sweeps.intervals import MeanInterval, of_logarithms
from simmpp.sweeps.winners.points import Points

SURE, UNSURE, EQUAL, ALONE, TOO_FEW_SEEDS = "sure", "unsure", "equal", "alone", "too few seeds"
"""Beyond the interval, within it, the same in all seeds, without others, without an interval."""


@dataclass(frozen=True)
class Contest:
    """The two fastest dataflows of one case."""

    best: int
    """Number of the fastest point."""
    second: int | None
    """Of the next; where seeds can't tell, of the first that they can't tell from it."""
    lead: float
    """T(second) / T(best): the mean of the seeds' own ratios; nan without common ones."""
    low: float
    high: float
    """Its 95 % interval."""
    certainty: str
    """SURE if the lead over every other dataflow is."""
    rivals: tuple[int, ...]
    """Those that the seeds can't tell from the fastest, or that are as fast."""
    flows: tuple[str, ...]
    """All dataflows that have a result."""
    seeds: int
    """Those that the two have in common."""
    ceiling: float | None
    """T(best) / T(replicated), likewise; None where the replicated scene was not run."""


def contests_of(points: Points) -> list[Contest]:
    """One for each case in which a dataflow has a result."""
    replicated = replicated_policies(points)
    contests = []
    for place in points.cases:
        ran = [n for n in place if points.runs[n]]
        flows = [n for n in ran if points.profits[n]["policy"] not in replicated]
        ceilings = [n for n in ran if points.profits[n]["policy"] in replicated]
        if flows:
            contests.append(_contest(points, flows, ceilings))
    return contests


def replicated_policies(points: Points) -> set[str]:
    """Policies that are no dataflow: the whole scene is in every memory, whatever the fraction."""
    scarce = [
        number
        for place in points.places
        if any(row["effective_fraction"] < 1 for other in place for row in points.runs[other])
        for number in place
    ]  # where all hold everything, as one PE does, nothing tells a dataflow from the ceiling
    titles = {points.profits[n]["policy"] for n in scarce if points.runs[n]}
    for number in scarce:
        if any(row["effective_fraction"] < 1 for row in points.runs[number]):
            titles.discard(points.profits[number]["policy"])
    named = {title for title, name in points.labels.items() if name == CEILING}
    return titles | named | {CEILING}


def _contest(points: Points, flows: list[int], ceilings: list[int]) -> Contest:
    times = means(points, flows)
    best, *others = sorted(flows, key=lambda n: times[n])
    ratios = {n: makespan_ratios(points, n, best) for n in others}
    verdicts = {n: verdict(of, points.confidence) for n, of in ratios.items()}
    certainty = _certainty([*verdicts.values()])
    second = next((n for n in others if verdicts[n] == certainty), None)
    lead = MeanInterval.unknown()
    if second is not None:
        lead = of_logarithms(ratios[second], points.confidence)
    top = makespan_ratios(points, best, ceilings[0]) if ceilings else []
    return Contest(
        best,
        second,
        lead.mean,
        lead.low,
        lead.high,
        certainty,
        tuple(n for n, found in verdicts.items() if found in (UNSURE, EQUAL)),
        tuple(points.flow(n) for n in (best, *others)),
        len(ratios[second]) if second is not None else len(points.runs[best]),
        of_logarithms(top).mean if top else None,
    )


def means(points: Points, flows: list[int]) -> dict[int, float]:
    """Mean logarithms of makespans over the seeds that all have, or each its own without such."""
    seeds = [set(points.seeds[n]) for n in flows]
    common = set.intersection(*seeds) or set.union(*seeds)
    return {
        n: fmean(math.log(max(r["makespan_ps"], 1)) for r in points.runs[n] if r["seed"] in common)
        for n in flows
    }


def makespan_ratios(points: Points, above: int, below: int) -> list[float]:
    """T(above) / T(below) for each seed that both have."""
    both = pairs(points.seeds[above], points.seeds[below])
    return [ratio(upper["makespan_ps"], lower["makespan_ps"]) for upper, lower in both]


def verdict(ratios: list[float], confidence: float) -> str:
    """Whether one is slower than the fastest."""
    if ratios and all(value == 1 for value in ratios):
        return EQUAL
    low = of_logarithms(ratios, confidence).low
    if math.isnan(low):
        return TOO_FEW_SEEDS
    return SURE if low > 1 else UNSURE


def _certainty(verdicts: Sequence[str]) -> str:
    """That of the least sure of all comparisons."""
    order = (TOO_FEW_SEEDS, UNSURE, EQUAL, SURE)
    return min(verdicts, key=order.index, default=ALONE)
