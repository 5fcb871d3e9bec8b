"""Points of a sweep with all that is known of them: their profits and the rows of their seeds."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from functools import cached_property
from statistics import fmean

from simmpp.report.page.arrangement import AXES, axes_of
from simmpp.sweeps.profits import profit_rows
from simmpp.sweeps.tables import Row

ACCOUNTS = {
    "compute": "compute_ps",
    "communication": "communication_ps",
    "waiting": "waiting_ps",
}
"""What PEs spend their time with, and its column."""
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
        """Shares of all PEs' time over all seeds, by account; all 0 without a result."""
        sums = {name: sum(row[c] for row in self.runs[number]) for name, c in ACCOUNTS.items()}
        total = sum(sums.values()) or 1
        return {name: value / total for name, value in sums.items()}

    def messages(self, number: int) -> dict[str, float]:
        """Messages by kind, means over seeds; all 0 without a result."""
        runs = self.runs[number]
        return {k: fmean(row[c] for row in runs) if runs else 0.0 for k, c in KINDS.items()}


def points_of(rows: Sequence[Row], further: tuple[str, ...]) -> Points:
    """Put the rows of each point together."""
    profits = profit_rows(rows, further)
    names = (*AXES, *further)
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
