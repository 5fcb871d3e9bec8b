"""Points of a sweep with all that is known of them: their profits and the rows of their seeds."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from statistics import fmean

from simmpp.common.files import Row
from simmpp.report.page.arrangement import AXES, axes_of
from simmpp.sweeps.profits import MEASURES, STATISTICS, profit_rows

ACCOUNTS = {
    "compute": "compute_ps",
    "communication": "communication_ps",
    "waiting": "waiting_ps",
}
"""What PEs spend their time with, and its column."""
STATISTICS_OF_ALL = tuple(measure + end for measure in MEASURES for end in STATISTICS)
KINDS = {
    "requests": "request_messages",
    "objects": "object_messages",
    "rays": "ray_messages",
    "loads": "load_messages",
}
"""Messages by kind, and their columns."""


@dataclass(frozen=True)
class Points:
    """A point is one policy at one place of the axes; all three lists go by its number."""

    profits: list[Row]
    """As in ``profits.csv``."""
    runs: list[list[Row]]
    """The rows of its seeds that did not fail."""
    groups: list[int]
    """Number of its place: what all policies there have in common."""
    further: tuple[str, ...]

    @cached_property
    def axes(self) -> dict[str, list[object]]:
        """The axes along which places differ, with their values."""
        return axes_of(self.profits, self.further)

    @cached_property
    def places(self) -> list[list[int]]:
        """The points of each place."""
        found: list[list[int]] = [[] for _ in range(max(self.groups, default=-1) + 1)]
        for number, group in enumerate(self.groups):
            found[group].append(number)
        return found

    def shares(self, number: int) -> dict[str, float]:
        """Shares of all PEs' time over all seeds, by account; none where a row does not know."""
        if not self._knows(number, ACCOUNTS.values()):
            return {}
        sums = {name: sum(row[c] for row in self.runs[number]) for name, c in ACCOUNTS.items()}
        total = sum(sums.values()) or 1
        return {name: value / total for name, value in sums.items()}

    def messages(self, number: int) -> dict[str, float]:
        """Messages by kind, means over seeds; none where a row does not know."""
        if not self._knows(number, KINDS.values()):
            return {}
        return {kind: fmean(row[c] for row in self.runs[number]) for kind, c in KINDS.items()}

    def _knows(self, number: int, columns: Iterable[str]) -> bool:
        runs = self.runs[number]
        return bool(runs) and all(row[column] != "" for column in columns for row in runs)


def points_of(rows: Sequence[Row], further: tuple[str, ...], known: Sequence[Row] = ()) -> Points:
    """Put the rows of each point together; of profits ``known`` the intervals are taken as such."""
    names = (*AXES, *further)
    by_key = {_key(row, names): row for row in known}
    profits = [_as_known(row, by_key.get(_key(row, names))) for row in profit_rows(rows, further)]
    of_point: dict[tuple[Hashable, ...], list[Row]] = {}
    for row in rows:
        of_point.setdefault(tuple(row[name] for name in (*names, "policy")), []).append(row)
    places: dict[tuple[Hashable, ...], int] = {}
    groups, runs = [], []
    for profit in profits:
        place = tuple(profit[name] for name in names)
        groups.append(places.setdefault(place, len(places)))
        runs.append([row for row in of_point[(*place, profit["policy"])] if not row["error"]])
    return Points(profits, runs, groups, further)


def _key(row: Row, names: Sequence[str]) -> tuple[Hashable, ...]:
    return (*(row.get(name) for name in names), row["policy"])


def _as_known(row: Row, known: Row | None) -> Row:
    """With the intervals of ``profits.csv``, if that is of the same seeds."""
    if known is None or known["n"] != row["n"]:
        return row
    return row | {name: known[name] for name in STATISTICS_OF_ALL}
