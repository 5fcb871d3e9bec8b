"""What differs between two sweeps, point by point, and whether it is more than seeds differ.

Seeds that both have are compared one by one, as everywhere; the 95 % interval of their ratios
(Student's t) says whether a difference is one. Without common seeds the two means' own intervals
must not overlap.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean

from simmpp.common.errors import ConfigError
from simmpp.common.units import format_ps
from simmpp.policy.registry import REFERENCE
from simmpp.report.page import words
from simmpp.report.page.arrangement import AXES
from simmpp.report.page.folder import Folder
from simmpp.report.page.points import Points, points_of
from simmpp.run.profit import ratio
from simmpp.studies.check.moves import percent
from simmpp.sweeps.intervals import interval

BEYOND, WITHIN, UNKNOWN = "beyond the interval", "within the interval", "too few seeds"
MEASURES = {
    "makespan": ("makespan_ps", False),
    "messages": ("messages", False),
    "time profit": ("makespan_ps", True),
    "message profit": ("messages", True),
}
"""The column of each, and whether it is the reference's over it."""
BySeed = Mapping[int, float]
Key = tuple[Hashable, ...]


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
class Difference:
    """Two sweeps side by side."""

    before: Points
    after: Points
    common: int
    """Points that both have."""
    changes: list[Change]
    only_before: list[str]
    only_after: list[str]


def difference_of(before: Folder, after: Folder) -> Difference:
    """Compare what both have; a column that only one has must have one value there."""
    further = tuple(name for name in before.further if name in after.further)
    for one, other in ((before, after), (after, before)):
        _refuse_other_axes(one, other)
    old, new = (points_of(folder.rows, further) for folder in (before, after))
    names = (*AXES, *further, "policy")
    of_old, of_new = ({_key(row, names): n for n, row in enumerate(p.profits)} for p in (old, new))
    changes = [
        change
        for key, number in of_new.items()
        if key in of_old
        for change in _changes(old, of_old[key], new, number)
    ]
    return Difference(
        old,
        new,
        len(of_old.keys() & of_new.keys()),
        changes,
        [_said(old, n) for key, n in of_old.items() if key not in of_new],
        [_said(new, n) for key, n in of_new.items() if key not in of_old],
    )


def _refuse_other_axes(one: Folder, other: Folder) -> None:
    for name in one.further:
        if name not in other.further and len({row[name] for row in one.rows}) > 1:
            raise ConfigError(
                f"{other.path}: has no column {name}, which varies in {one.path}: "
                "expected two sweeps along the same axes"
            )


def _key(row: Mapping[str, Hashable], names: Sequence[str]) -> Key:
    return tuple(row[name] for name in names)


def _said(points: Points, number: int) -> str:
    row = points.profits[number]
    return words.point(row, (*(points.axes or AXES[:3]), "policy"))


def _changes(old: Points, n_old: int, new: Points, n_new: int) -> list[Change]:
    found = []
    for measure in MEASURES:
        before, after = values(old, n_old, measure), values(new, n_new, measure)
        ratios, certainty = _compared(before, after)
        if certainty:
            means = fmean(before.values()), fmean(after.values())
            of = _said(new, n_new)
            found.append(Change(n_new, of, measure, *means, fmean(ratios), certainty))
    return found


def values(points: Points, number: int, measure: str) -> BySeed:
    """A measure of a point for each of its seeds."""
    column, is_profit = MEASURES[measure]
    own = {row["seed"]: row[column] for row in points.runs[number]}
    if not is_profit:
        return own
    place = points.places[points.groups[number]]
    references = [n for n in place if points.profits[n]["policy"] == REFERENCE]
    bases = {row["seed"]: row[column] for n in references for row in points.runs[n]}
    return {seed: ratio(bases[seed], own[seed]) for seed in own if seed in bases}


def _compared(before: BySeed, after: BySeed) -> tuple[list[float], str]:
    """Ratios of after to before, and whether they are sure; no certainty where nothing differs."""
    pairs = [(before[seed], after[seed]) for seed in sorted(before.keys() & after.keys())]
    if pairs:
        ratios = [1.0 if old == new else new / old if old else math.inf for old, new in pairs]
        if all(each == 1 for each in ratios):
            return ratios, ""
        ends = interval(ratios)
        return ratios, UNKNOWN if ends is None else _outside(1.0, 1.0, *ends)
    if not before or not after or fmean(before.values()) == fmean(after.values()):
        return [1.0], ""
    one, other = interval(list(before.values())), interval(list(after.values()))
    mean = fmean(after.values()) / (fmean(before.values()) or math.inf)
    sure = UNKNOWN if one is None or other is None else _outside(*one, *other)
    return [mean], sure


def _outside(low: float, high: float, other_low: float, other_high: float) -> str:
    return BEYOND if high < other_low or other_high < low else WITHIN


def summary(found: Difference) -> list[dict[str, str]]:
    """One line per measure: how many points moved, how many of them surely, and how far."""
    lines = []
    for measure in MEASURES:
        moved = sorted((c for c in found.changes if c.measure == measure), key=lambda c: c.ratio)
        sure = sum(change.certainty == BEYOND for change in moved)
        ends = [percent(moved[end].ratio - 1) for end in (0, -1)] if moved else ["", ""]
        lines.append(
            {
                "measure": measure,
                "points in both": str(found.common),
                "moved": str(len(moved)),
                BEYOND: str(sure),
                "from": ends[0],
                "to": ends[1],
            }
        )
    return lines


def ranked(changes: Sequence[Change]) -> list[Change]:
    """Sure ones first, then those that are farthest."""

    def distance(change: Change) -> float:
        return abs(math.log(change.ratio)) if 0 < change.ratio < math.inf else math.inf

    return sorted(changes, key=lambda c: (c.certainty != BEYOND, -distance(c), c.number))


def line(change: Change) -> dict[str, str]:
    """A change as cells of a table."""
    return {
        "point": change.of,
        "measure": change.measure,
        "before": _number(change.before, change.measure),
        "after": _number(change.after, change.measure),
        "change": percent(change.ratio - 1),
        "how sure": change.certainty,
    }


def _number(value: float, measure: str) -> str:
    if measure == "makespan":
        return format_ps(round(value))
    return f"{value:.5g}"
