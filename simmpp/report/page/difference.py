"""What differs between two sweeps, point by point, and whether it is more than seeds differ.

Seeds that both have are compared one by one, as everywhere; the 95 % interval of their ratios
(Student's t) says whether a difference is one. Without common seeds the two means' own intervals
must not overlap.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean
from typing import Any

from simmpp.common.errors import ConfigError
from simmpp.common.units import format_ps
from simmpp.methods.columns import PLACE
from simmpp.policy.parameters import REFERENCE
from simmpp.report.page.folder import Folder
from simmpp.run import words
from simmpp.run.profit import ratio
from simmpp.run.rows import pairs
from simmpp.sweeps.intervals import interval
from simmpp.sweeps.matching import extremes, matched, percent
from simmpp.sweeps.winners.contest import TOO_FEW_SEEDS
from simmpp.sweeps.winners.points import Points, points_of

BEYOND, WITHIN = "beyond the interval", "within the interval"
COMPARED = {
    "makespan": ("makespan_ps", False),
    "messages": ("messages", False),
    "time profit": ("makespan_ps", True),
    "message profit": ("messages", True),
}
"""The column of each, and whether it is the reference's over it."""
BySeed = Mapping[int, float]
NAMES = ("before", "after")
"""Of two sweeps, unless they have names of their own."""


@dataclass(frozen=True)
class Change:
    """One measure of one point that is in both sweeps and not equal."""

    number: int
    """Of the point in the second sweep."""
    of: str
    """The point in words."""
    measure: str
    before: float
    after: float
    ratio: float
    """after / before: the mean of the common seeds' own ratios."""
    certainty: str


@dataclass(frozen=True)
class SideBySide:
    """Two sweeps side by side."""

    before: Points
    after: Points
    common: int
    """Points that both have."""
    changes: list[Change]
    only_before: list[str]
    only_after: list[str]
    names: tuple[str, str] = NAMES
    """What the two are called."""
    failed: int = 0
    """Points that both have and that have no result in one of them, or in both."""

    @property
    def only(self) -> list[tuple[str, list[str]]]:
        """Points that only one has, by its name."""
        return list(zip(self.names, (self.only_before, self.only_after), strict=True))


def difference_of(before: Folder, after: Folder, names: tuple[str, str] = NAMES) -> SideBySide:
    """Compare what both have; a column that only one has must have one value there."""
    further = tuple(name for name in before.further if name in after.further)
    for one, other in ((before, after), (after, before)):
        _refuse_other_axes(one, other)
    old, new = (points_of(folder.rows, further, folder.profits) for folder in (before, after))
    changes: list[Change] = []
    gone, added, common, failed = [], [], 0, 0
    for _, number, number_now in matched(*(_numbers(points, further) for points in (old, new))):
        if number is not None and number_now is not None:
            common += 1
            failed += not (old.runs[number] and new.runs[number_now])
            changes += _changes(old, number, new, number_now)
        elif number is not None:
            gone.append(_said(old, number))
        elif number_now is not None:
            added.append(_said(new, number_now))
    return SideBySide(old, new, common, changes, gone, added, names, failed)


def _numbers(points: Points, further: Sequence[str]) -> dict[tuple[Hashable, ...], int]:
    """The number of each point by what names it."""
    names = (*PLACE, *further, "policy")
    return {tuple(row[name] for name in names): n for n, row in enumerate(points.profits)}


def _refuse_other_axes(one: Folder, other: Folder) -> None:
    for name in one.further:
        if name not in other.further and len({row[name] for row in one.rows}) > 1:
            raise ConfigError(
                f"{other.path}: has no column {name}, which varies in {one.path}: "
                "expected two sweeps along the same axes"
            )


def _said(points: Points, number: int) -> str:
    row = points.profits[number]
    return words.point(row, (*(points.axes or PLACE), "policy"))


def _changes(old: Points, n_old: int, new: Points, n_new: int) -> list[Change]:
    changes = []
    for measure in COMPARED:
        before, after = values(old, n_old, measure), values(new, n_new, measure)
        ratios, certainty = _compared(before, after)
        if certainty:
            means = fmean(before.values()), fmean(after.values())
            of = _said(new, n_new)
            changes.append(Change(n_new, of, measure, *means, fmean(ratios), certainty))
    return changes


def values(points: Points, number: int, measure: str) -> BySeed:
    """A measure of a point for each of its seeds."""
    column, is_profit = COMPARED[measure]
    own, place = points.seeds[number], points.places[points.groups[number]]
    if not is_profit:
        return {seed: row[column] for seed, row in own.items()}
    of_policy = {points.profits[n]["policy"]: points.seeds[n] for n in place}
    both = pairs(of_policy.get(REFERENCE, {}), own)
    return {row["seed"]: ratio(base[column], row[column]) for base, row in both}


def _compared(before: BySeed, after: BySeed) -> tuple[list[float], str]:
    """Ratios of after to before, and whether they are sure; no certainty where nothing differs."""
    pairs = [(before[seed], after[seed]) for seed in sorted(before.keys() & after.keys())]
    if pairs:
        ratios = [1.0 if old == new else new / old if old else math.inf for old, new in pairs]
        if all(value == 1 for value in ratios):
            return ratios, ""
        ends = interval(ratios)
        return ratios, TOO_FEW_SEEDS if ends is None else _outside(1.0, 1.0, *ends)
    if not before or not after or fmean(before.values()) == fmean(after.values()):
        return [1.0], ""
    one, other = interval(list(before.values())), interval(list(after.values()))
    mean = fmean(after.values()) / (fmean(before.values()) or math.inf)
    sure = TOO_FEW_SEEDS if one is None or other is None else _outside(*one, *other)
    return [mean], sure


def _outside(low: float, high: float, other_low: float, other_high: float) -> str:
    return BEYOND if high < other_low or other_high < low else WITHIN


def changes_by_measure(difference: SideBySide) -> list[dict[str, str]]:
    """One line per measure: how many points moved, how many of them surely, and how far."""
    lines = []
    for measure in COMPARED:
        moved = [change for change in difference.changes if change.measure == measure]
        lines.append(
            {
                "measure": measure,
                "points in both": str(difference.common),
                "moved": str(len(moved)),
                BEYOND: str(sum(change.certainty == BEYOND for change in moved)),
                **extremes(change.ratio - 1 for change in moved),
            }
        )
    return lines


def ranked(changes: Sequence[Change]) -> list[Change]:
    """Sure ones first, then those that are farthest."""

    def distance(change: Change) -> float:
        return abs(math.log(change.ratio)) if 0 < change.ratio < math.inf else math.inf

    return sorted(changes, key=lambda c: (c.certainty != BEYOND, -distance(c), c.number))


def line(change: Change, names: tuple[str, str] = NAMES) -> dict[str, str]:
    """A change as cells of a table; ``names`` are the sweeps'."""
    cells = {"point": change.of, "measure": change.measure}
    ends = {"change": percent(change.ratio - 1), "how sure": change.certainty}
    before, after = NAMES if {*names} & {*cells, *ends} else names
    cells[before] = _number(change.before, change.measure)
    cells[after] = _number(change.after, change.measure)
    return cells | ends


def apart(sweeps: SideBySide) -> str:
    """Why no point is in both: the first key with other values in each, if there is one."""
    old, new = (points.profits for points in (sweeps.before, sweeps.after))
    for name in (*PLACE, *sweeps.after.further, "policy") if old and new else ():
        before, after = ({row[name]: None for row in rows} for rows in (old, new))
        if not before.keys() & after.keys():
            texts = (_some(name, cells) for cells in (before, after))
            sides = zip(texts, sweeps.names, strict=True)
            return f"{words.SHORT.get(name, name)} is " + ", ".join(map(" ".join, sides))
    return ""


def _some(name: str, cells: Iterable[Any]) -> str:
    first, *more = (words.value(name, cell) for cell in cells)
    return f"{first} (and {len(more)} more)" if more else first


def _number(value: float, measure: str) -> str:
    if measure == "makespan":
        return format_ps(round(value))
    return f"{value:.5g}"
