"""What limits the points of a page: parts of their makespans, as far as rows and record tell."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from simmpp.common.files import Row
from simmpp.common.units import format_ps
from simmpp.report.page.folder import Folder
from simmpp.report.page.together import FOLDER
from simmpp.run import words
from simmpp.run.limits import COMPUTE, PARTS, Limits, MessageCosts, limits_of, together
from simmpp.run.machines import machine_of
from simmpp.sweeps.intervals import of_logarithms
from simmpp.sweeps.winners.contest import contests_of
from simmpp.sweeps.winners.points import ACCOUNTS, Points
from simmpp.sweeps.winners.sentence import Sentence

NEEDED = (*ACCOUNTS.values(), "messages", "bytes_sent", "rays_sent", "request_messages")
"""Columns that a method may not know."""


@dataclass(frozen=True)
class PointLimits:
    """The limits of all points, by number; of what is not known there are none."""

    points: Points
    of: Mapping[int, Limits]

    @property
    def parts(self) -> list[str]:
        """Those that there are, in their order."""
        there = {part for limits in self.of.values() for part in limits.parts_ps}
        return [part for part in PARTS if part in there]

    def shares(self, number: int) -> dict[str, float]:
        """Of the makespan, each part; nothing of what is not known."""
        shares = self.of[number].shares if number in self.of else {}
        return {part: shares.get(part, 0.0) for part in self.parts} if shares else {}

    def told(self, number: int) -> str:
        """What limits a point most, and what would help first."""
        return f"{words.capital(str(self.of[number]))}." if number in self.of else ""


def limits_of_points(folder: Folder, points: Points) -> PointLimits:
    """Work them out from rows, the record's machines and, of a run, the accounts of its PEs."""
    folders = folder.parts or {"": folder}
    told = {name: (f.record, _accounts(f.record)) for name, f in folders.items()}
    found = {}
    for number, profit in enumerate(points.profits):
        record, accounts = told[profit[FOLDER] if folder.parts else ""]
        runs, nb = points.runs[number], profit["processors"]
        of_pes = accounts.get(profit["policy"], ()) if len(runs) == 1 else ()
        if runs and all(row.get(name, "") != "" for row in runs for name in NEEDED):
            costs = _costs(record, profit)
            found[number] = together(limits_of(row, nb, costs, *of_pes) for row in runs)
    return PointLimits(points, found)


def _costs(record: Mapping[str, Any], row: Row) -> MessageCosts | None:
    """Of a row's machine, as far as its record tells."""
    with suppress(KeyError, TypeError, ValueError):  # another version's record
        if constants := machine_of(record, row):
            return MessageCosts.of(constants)
    return None


def _accounts(record: Mapping[str, Any]) -> dict[str, tuple[list[int], list[int]]]:
    """Compute and communication of each PE, by policy: the record of a run has them."""
    policies = record.get("policies")
    found = {}
    for of in policies if isinstance(policies, list) else []:
        with suppress(KeyError, TypeError):
            found[of["policy"]] = of["pes"]["compute_ps"], of["pes"]["communication_ps"]
    return found


def limit_sentences(limits: PointLimits) -> Iterator[Sentence]:
    """What limits the fastest dataflow of each case."""
    points = limits.points
    best = [contest.best for contest in contests_of(points) if contest.best in limits.of]
    if len(best) == 1:
        flow = words.capital(points.flow(best[0]))
        yield Sentence(f"{flow} is {limits.of[best[0]]}.", tuple(best))
    elif best:
        counts = Counter(limits.of[number].first for number in best)
        near, parts = counts.pop(COMPUTE, 0), list[str]()
        for part, count in counts.most_common():
            of = [limits.of[n].shares[part] * 100 for n in best if limits.of[n].first == part]
            number = f"{count} of {len(best)} cases" if not parts else f"{count}"
            parts.append(f"by {part} in {number} ({words.span(of)} % of the makespan)")
        texts = []
        if parts:
            most = ", ".join(parts)
            texts.append(f"besides computing, the fastest dataflow is limited most {most}")
        if near:
            where = f"in {near} of {len(best)} cases"
            texts.append(f"{where} it does little but compute: little else is left to gain")
        yield Sentence(f"{words.capital('; '.join(texts))}.", tuple(best))


def limit_table(limits: PointLimits) -> list[Row]:
    """A line for each policy of the only case, or for the fastest dataflow of each case."""
    points = limits.points
    contests = contests_of(points)
    is_one = len(points.cases) == 1
    numbers = list(limits.of) if is_one else [c.best for c in contests if c.best in limits.of]
    return [_line(limits, number, list(points.axes)) for number in numbers]


def _line(limits: PointLimits, number: int, axes: list[str]) -> Row:
    points = limits.points
    makespan = of_logarithms([row["makespan_ps"] for row in points.runs[number]]).mean
    of, shares = limits.of[number], limits.shares(number)
    return {
        **{words.SHORT.get(n, n): words.value(n, points.at(number, n)) for n in axes},
        "policy": points.flow(number),
        "makespan": format_ps(int(float(f"{makespan:.4g}"))),
        **{part: f"{share * 100:.3g} %" for part, share in shares.items()},
        "limited most by": of.first,
        "would help first": of.help[of.first],
    }
