"""Points of a sweep with all that is known of them: their profits and the rows of their seeds."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain
from statistics import fmean
from types import MappingProxyType
from typing import Any

from simmpp.common.files import Row, sort_key
from simmpp.methods.columns import KEYS, PLACE
from simmpp.policy.parameters import CLASSICAL, REFERENCE
from simmpp.run import words
from simmpp.run.rows import Seeds, by_place, finished, is_unfit, pairs
from simmpp.sweeps.intervals import PLAIN
from simmpp.sweeps.profits import MEASURES, profit_rows, profits_in_order
from simmpp.sweeps.winners.capacities import in_bytes

KEY_AXES = tuple(name for name in KEYS if name not in ("effective_fraction", "policy", "seed"))
ACCOUNTS = {account: f"{account}_ps" for account in ("compute", "communication", "waiting")}
"""What PEs spend their time with, and its column."""
KINDS = {f"{kind}s": f"{kind}_messages" for kind in ("request", "object", "ray", "load")}
"""Messages by kind, and their columns."""


NO_LABELS: Mapping[str, str] = MappingProxyType({})


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
    labels: Mapping[str, str] = field(default_factory=dict)
    """Policies by label, as far as known."""
    confidence: float = PLAIN
    """Of the quantiles of intervals, which are of 95 % however seeds were chosen."""
    unfit: Sequence[Sequence[Row]] = ()
    """Its rows that did not fit into memory, or came to no end there."""

    def name(self, number: int) -> str:
        """The policy of a point, where its label is another one's or known; else its label."""
        title = str(self.profits[number]["policy"])
        return self.labels.get(title, title)

    def references(self, number: int) -> Seeds:
        """The rows of object dataflow at the place of a point."""
        place = self.places[self.groups[number]]
        found = (n for n in place if self.profits[n]["policy"] == REFERENCE)
        return next((self.seeds[n] for n in found), {})

    def flow(self, number: int) -> str:
        """The policy of a point as the paper calls it."""
        return words.policy(str(self.profits[number]["policy"]))

    def taken(self, number: int) -> str:
        """``"Send the rays: ray dataflow"``; a label with what it is a label of, if known."""
        flow, name = self.flow(number), self.name(number)
        if name not in words.ACTIONS:
            return words.capital(flow)
        is_label = name != self.profits[number]["policy"]
        return f"{words.ACTIONS[name]}: {flow}{f' ({words.policy(name)})' if is_label else ''}"

    @cached_property
    def classical(self) -> frozenset[str]:
        """Titles of the classical dataflows."""
        labels = {label for label, name in self.labels.items() if name in CLASSICAL}
        return frozenset({*CLASSICAL, *labels})

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

    @cached_property
    def cases(self) -> list[list[int]]:
        """The places; those that are the same simulations, wherever they were asked for, once."""
        found: dict[object, list[int]] = {}
        for place in self.places:
            keys = self._keys(place), self._held[place[0]], self._simulations(place)
            found.setdefault(keys, place)
        return list(found.values())

    @cached_property
    def repeated(self) -> frozenset[int]:
        """Points of places that are the simulations of an earlier one."""
        return frozenset(range(len(self.profits))) - frozenset(chain(*self.cases))

    def held(self, number: int) -> Any:
        """Where a point lies along x: the share of the objects that PEs of its place really hold.

        That is at least their own objects, and a whole number of them. Where several places hold
        the same and are different simulations all the same, as with room for x fetched objects
        besides, each lies where it was asked for.
        """
        return self._held[number]

    def at(self, number: int, name: str) -> Any:
        """Where a point lies along an axis, in words: x as asked, unless PEs hold more than that.

        A whole number of objects is not told from what was asked for.
        """
        cell = self.profits[number][name]
        is_less = (
            name == "fraction" and cell != "" and cell * self.profits[number]["processors"] < 1
        )
        return self._held[number] if is_less else cell

    @cached_property
    def _held(self) -> list[Any]:
        alike: dict[tuple[object, ...], list[list[int]]] = {}
        for place in self.places:
            alike.setdefault((self._keys(place), self._least_held(place)), []).append(place)
        held: list[Any] = [row["fraction"] for row in self.profits]
        for (_, share), places in alike.items():
            if share != "" and len({self._simulations(place) for place in places}) == 1:
                for number in chain(*places):
                    held[number] = share if held[number] != "" else ""
        return held

    def _keys(self, place: list[int]) -> tuple[object, ...]:
        """What names a place, but x."""
        names = (name for name in (*PLACE, *self.further) if name != "fraction")
        return tuple(self.profits[place[0]][name] for name in names)

    def _least_held(self, place: list[int]) -> Any:
        """What PEs hold there, by the policy that holds least; the replicated scene is all."""
        cells = [self.profits[number]["effective_fraction"] for number in place]
        return min((cell for cell in cells if cell != ""), default="")

    def _simulations(self, place: list[int]) -> tuple[object, ...]:
        profits = [[self.profits[n][key] for key in ("policy", *MEASURES)] for n in place]
        rows = (r for n in place for r in self.runs[n])
        return str(profits), *((r["seed"], r["makespan_ps"], r["messages"]) for r in rows)

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
    confidence: float = PLAIN,
) -> Points:
    """Put the rows of each point together; ``labels`` name the policy of each label.

    ``known`` are profits of ``profits.csv``, and taken as they are: only who wrote them knows by
    which rule sweeps stopped. They are computed here for places where there are none, or none of
    these seeds, as when a sweep at work has written one of the two files and not yet the other.
    """
    names = (*PLACE, *further)
    places = by_place(in_bytes(rows), names)
    of_place: dict[tuple[object, ...], dict[str, Row]] = {}
    for row in in_bytes(known):
        of_place.setdefault(tuple(row.get(name) for name in names), {})[row["policy"]] = row
    written: list[Row] = []
    rest: list[Row] = []
    for place, policies in places.items():
        if _counts(policies) == {title: row["n"] for title, row in of_place.get(place, {}).items()}:
            written += of_place[place].values()
        else:
            rest += (row for seeds in policies.values() for row in seeds.values())
    profits = profits_in_order([*written, *profit_rows(rest, further)], further)
    of = [places[tuple(row[n] for n in names)][row["policy"]] for row in profits]
    unfit = [[row for row in every.values() if is_unfit(row)] for every in of]
    seeds = [finished(every) for every in of]
    return Points(profits, seeds, _groups(profits, names), further, labels, confidence, unfit)


def points_of_profits(profits: Sequence[Row], further: Sequence[str]) -> Points:
    """Points of which nothing is known but their profits."""
    groups = _groups(profits, (*PLACE, *further))
    nothing: list[Seeds] = [{} for _ in profits]
    return Points(profits, nothing, groups, tuple(further), unfit=[[] for _ in profits])


def _groups(profits: Sequence[Row], names: Sequence[str]) -> list[int]:
    """The number of each point's place."""
    numbers: dict[tuple[object, ...], int] = {}
    return [numbers.setdefault(tuple(row[n] for n in names), len(numbers)) for row in profits]


def _counts(policies: Mapping[str, Seeds]) -> dict[str, int]:
    """How many profits each policy of a place has."""
    references = policies.get(REFERENCE, {})
    return {policy: len(pairs(references, seeds)) for policy, seeds in policies.items()}
