"""From which capacity on a policy is about as fast as with unbounded memory."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from simmpp.common.files import Row
from simmpp.methods.columns import PLACE
from simmpp.run import words
from simmpp.run.rows import KNEES
from simmpp.run.words import CAPACITY, UNBOUNDED
from simmpp.sweeps.intervals import of_logarithms
from simmpp.sweeps.winners.contest import makespan_ratios
from simmpp.sweeps.winners.points import Points, points_of

LONGER = (1.05, 2.0, 10.0)
"""How many times as long as with unbounded memory."""
LEAST = "least_fitting_bytes"
KNEES_BYTES = tuple(f"knee_bytes_{longer:g}" for longer in LONGER)


class Knee(NamedTuple):
    """One policy at one place of all axes but the capacity."""

    reference: int
    """Number of the point without a capacity or, where there is none, of the largest that fits."""
    least: int
    """Bytes of the least capacity that has a result."""
    knee_bytes: tuple[int | None, ...]
    """For each of LONGER, the least capacity with a makespan of at most so many times; None where
    no capacity of the sweep has."""


def knees(points: Points) -> list[Knee]:
    """Those of a sweep along the capacity.

    Makespans need not fall with the capacity: the smallest counts, whatever larger ones take.
    """
    if CAPACITY not in points.axes:
        return []
    others = [name for name in points.axes if name != CAPACITY]
    curves: dict[tuple[object, ...], dict[object, int]] = {}
    for number, row in enumerate(points.profits):
        if points.runs[number]:
            key = (*(row[name] for name in others), row["policy"])
            curves.setdefault(key, {})[row[CAPACITY]] = number
    return [_knee(points, curve) for curve in curves.values() if any(map(words.is_number, curve))]


def _knee(points: Points, curve: dict[object, int]) -> Knee:
    bounded = {size: n for size, n in curve.items() if isinstance(size, int)}
    reference = curve.get(UNBOUNDED, bounded[max(bounded)])
    longer = {
        size: of_logarithms(makespan_ratios(points, n, reference)).mean
        for size, n in sorted(bounded.items())
    }
    found = (next((size for size, of in longer.items() if of <= most), None) for most in LONGER)
    return Knee(reference, min(bounded), tuple(found))


def knee_tables(
    rows: Sequence[Row], further: tuple[str, ...], profits: Sequence[Row]
) -> dict[str, tuple[list[Row], Sequence[str]]]:
    """Rows and columns of ``knees.csv``; none of a sweep that does not go along the capacity."""
    if CAPACITY not in further:
        return {}
    found = knee_rows(points_of(rows, further, profits))
    return {KNEES: (found, knee_columns(further))}


def knee_columns(further: Sequence[str]) -> tuple[str, ...]:
    """The columns of ``knees.csv``; ``further`` are those of a sweep's keys."""
    others = (name for name in further if name != CAPACITY)
    return (*PLACE, *others, "policy", "compared_with", LEAST, *KNEES_BYTES)


def knee_rows(points: Points) -> list[Row]:
    """A row for each of them, in bytes; empty where no capacity of the sweep is enough."""
    rows = []
    for knee in knees(points):
        row = points.profits[knee.reference]
        sizes = ("" if size is None else size for size in knee.knee_bytes)
        found = dict(zip(KNEES_BYTES, sizes, strict=True))
        rows.append({**row, "compared_with": row[CAPACITY], LEAST: knee.least, **found})
    return rows


def knee_table(points: Points) -> list[Row]:
    """A line for each of them, in words."""
    others = [name for name in points.axes if name != CAPACITY]
    lines = []
    for knee in knees(points):
        row = points.profits[knee.reference]
        cells = [
            "-" if size is None else words.value(CAPACITY, size)
            for size in (knee.least, *knee.knee_bytes)
        ]
        columns = ("least that fits", *(f"{of:g} x" for of in LONGER))
        lines.append(
            {
                **{
                    words.SHORT.get(n, n): words.value(n, points.at(knee.reference, n))
                    for n in others
                },
                "policy": points.flow(knee.reference),
                **dict(zip(columns, cells, strict=True)),
                "compared with": words.said(CAPACITY, row[CAPACITY]),
            }
        )
    return lines
