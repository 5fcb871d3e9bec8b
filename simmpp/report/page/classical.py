"""The best classical dataflow under the same memory, beside each dataflow that is not classical.

How pixels, owners and residents are dealt costs no memory and may decide more than the dataflow, so
where a sweep tries several ways, each side has its best. Under the same memory is what has the same
fraction or bytes for residents, and room for no more fetched objects.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from simmpp.common.errors import ConfigError
from simmpp.common.files import Row
from simmpp.common.units import share
from simmpp.methods.columns import PLACE
from simmpp.placement.rooms import AS_FRACTION
from simmpp.policy.parameters import CLASSICAL
from simmpp.run.words import is_number
from simmpp.sweeps.intervals import of_logarithms
from simmpp.sweeps.winners.contest import makespan_ratios, means, replicated_policies
from simmpp.sweeps.winners.points import Points

KEPT = "memory.transient"
FREE = ("placement.pixels", "placement.owners", "memory.residents", KEPT)
"""Axes along which each side has its best."""


@dataclass(frozen=True)
class Duel:
    """A dataflow against the best classical one."""

    classical: int
    """Number of the classical point."""
    other: int
    ratio: float
    """T(other) / T(classical): the mean of the seeds' own ratios; nan without common ones."""
    absent: tuple[str, ...]
    """Classical policies that were not run with that memory, or failed."""


def duels_of(points: Points) -> list[Duel]:
    """One for each dataflow that is not classical and each memory that it is run with."""
    return [
        _duel(points, rivals, flows)
        for classical, others in _groups(points)
        for flows in others
        if (rivals := [n for n in classical if _keeps_no_more(points, n, flows[0])])
    ]


def _groups(points: Points) -> Iterator[tuple[list[int], list[list[int]]]]:
    """Points that differ in the free axes only: the classical ones, and each other dataflow's with
    the same room for fetched objects."""
    names = [name for name in (*PLACE, *points.further) if name not in FREE]
    groups: dict[tuple[object, ...], list[int]] = {}
    for number, row in enumerate(points.profits):
        if points.runs[number]:
            groups.setdefault(tuple(row[name] for name in names), []).append(number)
    replicated = replicated_policies(points)
    for group in groups.values():
        others: dict[tuple[object, ...], list[int]] = {}
        for number in group:
            row = points.profits[number]
            if row["policy"] not in points.classical | replicated:
                others.setdefault((row["policy"], row.get(KEPT)), []).append(number)
        classical = [n for n in group if points.profits[n]["policy"] in points.classical]
        yield classical, list(others.values())


def _duel(points: Points, rivals: list[int], flows: list[int]) -> Duel:
    times = means(points, [*rivals, *flows])
    best, other = (min(numbers, key=lambda n: times[n]) for numbers in (rivals, flows))
    ratios = makespan_ratios(points, other, best)
    there = {points.name(number) for number in rivals}
    absent = tuple(name for name in CLASSICAL if name not in there)
    return Duel(best, other, of_logarithms(ratios).mean, absent)


def _keeps_no_more(points: Points, one: int, other: int) -> bool:
    """Whether a point has room for no more fetched objects than another of the same fraction."""
    if KEPT not in points.further:
        return True
    (unit, kept), (other_unit, most) = (_kept(points.profits[number]) for number in (one, other))
    return kept == 0 or (unit == other_unit and kept <= most)


def _kept(row: Row) -> tuple[object, float]:
    """Room for fetched objects with its unit; numbers of objects can't be compared with shares."""
    cell = row[KEPT]
    if is_number(cell):
        return "objects", cell
    if cell == AS_FRACTION and row["fraction"] != "":
        return "share", row["fraction"]
    try:
        return "share", float(share(cell))
    except ConfigError:
        return cell, math.inf
