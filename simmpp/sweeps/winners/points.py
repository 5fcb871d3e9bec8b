"""Points of a sweep with all that is known of them: their profits and the rows of their seeds."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from statistics import fmean

from simmpp.common.files import Row, sort_key
from simmpp.methods.columns import KEYS, PLACE
from simmpp.policy.parameters import CLASSICAL, REFERENCE
from simmpp.run.rows import Seeds, by_place, finished, pairs
from simmpp.sweeps.profits import profit_rows, profits_in_order

KEY_AXES = tuple(name for name in KEYS if name not in ("effective_fraction", "policy", "seed"))
ACCOUNTS = {account: f"{account}_ps" for account in ("compute", "communication", "waiting")}
"""What PEs spend their time with, and its column."""
KINDS = {f"{kind}s": f"{kind}_messages" for kind in ("request", "object", "ray", "load")}
"""Messages by kind, and their columns."""


NO_LABELS: Mapping[str, str] = {}


@dataclass(frozen=True)
class Points:
    """A point is one policy at one place of the axes; all three lists go by its number."""

    profits: Sequence[Row]
    """As in ``profits.csv``."""
    seeds: list[Seeds]
    """Its rows that did not fail."""
    groups: list[int]
    """Number of its place: what all policies there have in common."""
    further: tuple[str, ...]
    classical: frozenset[str] = frozenset(CLASSICAL)
    """Titles of the classical dataflows."""

    @cached_property
    def runs(self) -> list[list[Row]]:
        """The same without the seeds."""
        return [list(seeds.values()) for seeds in self.seeds]

    @cached_property
    def axes(self) -> dict[str, list[object]]:
        """The axes along which places differ, with their values."""
        return varying_axes(self.profits, self.further)

    @cached_property
    def places(self) -> list[list[int]]:
        """The points of each place."""
        places: list[list[int]] = [[] for _ in range(max(self.groups, default=-1) + 1)]
        for number, group in enumerate(self.groups):
            places[group].append(number)
        return places

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


def varying_axes(rows: Sequence[Row], further: Sequence[str]) -> dict[str, list[object]]:
    """The axes along which rows differ, but for policy and seed."""
    axes: dict[str, list[object]] = {}
    for name in (*KEY_AXES, *further):
        values = {row[name] for row in rows}
        if len(values) > 1:
            axes[name] = sorted(values, key=lambda cell: sort_key({"": cell}, ("",)))
    return axes


def points_of(
    rows: Sequence[Row],
    further: tuple[str, ...],
    known: Sequence[Row] = (),
    labels: Mapping[str, str] = NO_LABELS,
) -> Points:
    """Put the rows of each point together; ``labels`` name the policy of each label.

    ``known`` are profits of ``profits.csv``, and taken as they are: only who wrote them knows by
    which rule sweeps stopped. They are computed here for places where there are none, or none of
    these seeds, as when a sweep at work has written one of the two files and not yet the other.
    """
    names = (*PLACE, *further)
    places = by_place(rows, names)
    of_place: dict[tuple[object, ...], dict[str, Row]] = {}
    for row in known:
        of_place.setdefault(tuple(row.get(name) for name in names), {})[row["policy"]] = row
    written: list[Row] = []
    rest: list[Row] = []
    for place, policies in places.items():
        if _counts(policies) == {title: row["n"] for title, row in of_place.get(place, {}).items()}:
            written += of_place[place].values()
        else:
            rest += (row for seeds in policies.values() for row in seeds.values())
    profits = profits_in_order([*written, *profit_rows(rest, further)], further)
    numbers: dict[tuple[object, ...], int] = {}
    groups, seeds = [], []
    for profit in profits:
        place = tuple(profit[name] for name in names)
        groups.append(numbers.setdefault(place, len(numbers)))
        seeds.append(finished(places[place][profit["policy"]]))
    classical = {*CLASSICAL, *(label for label, name in labels.items() if name in CLASSICAL)}
    return Points(profits, seeds, groups, further, frozenset(classical))


def _counts(policies: Mapping[str, Seeds]) -> dict[str, int]:
    """How many profits each policy of a place has."""
    references = policies.get(REFERENCE, {})
    return {policy: len(pairs(references, seeds)) for policy, seeds in policies.items()}
