"""What moved between two sweeps of one configuration: integers, profits, points gone and new."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from simmpp.methods.columns import FURTHER, NUMBERS
from simmpp.sweeps.matching import extremes, matched, percent

Cells = Mapping[str, str]
"""A line of a CSV file, as it is written."""

EXACT_COLUMNS = ("effective_fraction", *NUMBERS, *FURTHER, "error")
"""Columns of ``results.csv`` that must be equal unless tolerances are given."""
GUARDED = ("time_profit", "message_profit", "speedup", "efficiency")
"""Columns of ``profits.csv`` that a tolerance may be given for."""
DERIVED = tuple(f"{name}{end}" for name in GUARDED[:2] for end in ("_low", "_high", "_min", "_max"))
"""Columns that follow from the others; their last digits are the statistics library's."""
NOT_KEYS = {*EXACT_COLUMNS, *GUARDED, *DERIVED, "engine", "n"}
POINT, THERE, MISSING, NEW = "point", "there", "missing", "new"


@dataclass(frozen=True)
class Sweep:
    """The tables of a folder, ``results.csv`` and ``profits.csv``, and what they are of."""

    results: Sequence[Cells]
    profits: Sequence[Cells]
    record: Mapping[str, Any] = field(default_factory=dict)
    """``run.json``."""


@dataclass(frozen=True)
class Move:
    """One value that is not what it was, or a point that is gone or new."""

    key: tuple[tuple[str, str], ...]
    """Column and value of each axis; one with a seed is of ``results.csv``."""
    measure: str
    baseline: str
    now: str
    allowed: Fraction | None = None
    """Relative change that would have been fine; None where nothing is."""

    @property
    def of_curve(self) -> bool:
        """It is a value of ``profits.csv``; those of ``results.csv`` have a seed."""
        return "seed" not in dict(self.key)

    @property
    def change(self) -> float | None:
        """(now - baseline) / baseline; None where that is no number."""
        return relative_change(self.baseline, self.now)


def moves(baseline: Sweep, now: Sweep, tolerances: Mapping[str, Fraction]) -> list[Move]:
    """Everything that moved, profits first; without tolerances nothing may.

    With tolerances (of names in GUARDED) only these profits, points and errors are compared.
    """
    allowed = {
        name: tolerances.get(name) for name in GUARDED if not tolerances or name in tolerances
    }
    exact = ("error",) if tolerances else EXACT_COLUMNS
    return [
        *_of_table(baseline.profits, now.profits, allowed),
        *_of_table(baseline.results, now.results, dict.fromkeys(exact)),
    ]


def _of_table(
    baseline: Sequence[Cells], now: Sequence[Cells], allowed: Mapping[str, Fraction | None]
) -> Iterator[Move]:
    old, new = ({key_of_row(row): row for row in rows} for rows in (baseline, now))
    for key, was, is_now in matched(old, new):
        if is_now is None:
            yield Move(key, POINT, THERE, MISSING)
        elif was is None:
            yield Move(key, POINT, MISSING, NEW)
        else:
            for name, tolerance in allowed.items():
                before, after = was.get(name, ""), is_now.get(name, "")
                if not _within(before, after, tolerance):
                    yield Move(key, name, before, after, tolerance)


def key_of_row(row: Cells) -> tuple[tuple[str, str], ...]:
    """The axes of a row: all columns that are no result."""
    return tuple((name, value) for name, value in row.items() if name not in NOT_KEYS)


def _within(before: str, after: str, tolerance: Fraction | None) -> bool:
    if before == after:
        return True
    change = relative_change(before, after)
    return tolerance is not None and change is not None and abs(change) <= tolerance


def relative_change(before: str, after: str) -> float | None:
    """(after - before) / before, or None where there is no such number."""
    try:
        old, new = float(before), float(after)
    except ValueError:
        return None
    change = (new - old) / old if old else math.nan
    return change if math.isfinite(change) else None


def moves_by_measure(moves: Sequence[Move]) -> list[dict[str, str]]:
    """One line per measure: how many rows moved, and by how much at least and at most."""
    lines = []
    for measure in dict.fromkeys(move.measure for move in moves):
        of_measure = [move for move in moves if move.measure == measure]
        changes = [move.change for move in of_measure if move.change is not None]
        lines.append({"measure": measure, "rows": str(len(of_measure)), **extremes(changes)})
    return lines


def lines(moves: Sequence[Move], most: int | None = None) -> list[dict[str, str]]:
    """One line per move, or the ``most`` that moved farthest, in their order."""
    ranked = sorted(range(len(moves)), key=lambda n: (-_distance(moves[n]), n))
    farthest = [moves[n] for n in sorted(ranked if most is None else ranked[:most])]
    axes = list(dict.fromkeys(name for move in farthest for name, _ in move.key))
    return [_line(move, axes) for move in farthest]


def _distance(move: Move) -> float:
    change = move.change
    return math.inf if change is None else abs(change)


def _line(move: Move, axes: Sequence[str]) -> dict[str, str]:
    key = dict(move.key)
    change = move.change
    return {
        **{axis: key.get(axis, "") for axis in axes},
        "measure": move.measure,
        "baseline": move.baseline,
        "now": move.now,
        "change": "" if change is None else percent(change),
        "allowed": "none" if move.allowed is None else f"{float(move.allowed) * 100:g} %",
    }
