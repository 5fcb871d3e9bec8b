"""What does not fit into the memory of PEs, and by how much: rows of sweeps with a capacity."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from simmpp.common.units import format_bytes
from simmpp.run import words
from simmpp.sweeps.winners.points import Points
from simmpp.sweeps.winners.regions import extent, region
from simmpp.sweeps.winners.sentence import Sentence

FITS, LACKS, STUCK, EXCEEDS = "fits", "does not fit", "stuck", "exceeds"
"""It runs; its parts and least shares are more than the capacity; it came to no end, as PEs may not
escape; it ran with queues without end (``flow: none``) and held more than the capacity."""


class Fit(NamedTuple):
    """How a point gets on with the memory of its PEs."""

    kind: str
    bytes: int
    """That one PE lacks, or held too much: the most of all seeds."""
    reason: str = ""
    """Why it is stuck."""

    def __str__(self) -> str:
        """``"does not fit: lacks 1.2 GB"``."""
        size = _rounded(self.bytes)
        more = {LACKS: f": lacks {size}", EXCEEDS: f" by {size}"}
        if self.reason:
            more[STUCK] = f": {self.reason}"
        return self.kind + more.get(self.kind, "")


def fit_of(points: Points, number: int) -> Fit | None:
    """Of a point, over its seeds; None where memory has no end."""
    unfit = points.unfit[number]
    rows = [row for row in (*unfit, *points.runs[number]) if words.is_number(row.get("fits"))]
    if not rows:
        return None
    lacking = max(row["exceeds_bytes"] or 0 for row in rows)
    if any(row["fits"] == 0 for row in unfit):
        return Fit(LACKS, lacking)
    if unfit:
        return Fit(STUCK, lacking, unfit[0].get("reason", ""))
    return Fit(FITS if all(row["fits"] for row in rows) else EXCEEDS, lacking)


def nothing_ran(points: Points) -> Sentence:
    """That there is no result, or that nothing fits and what would do at least."""
    unfit = [n for n in range(len(points.profits)) if _least(points, n)]
    if not unfit:
        return Sentence("No point has a result.")
    best = min(unfit, key=lambda n: _least(points, n))
    axes = [name for name in points.axes if name != words.CAPACITY]
    where = words.point(points.profits[best], ["policy", *axes])
    who = "No dataflow" if any(points.runs) else "Nothing"
    least = f"at least {_rounded(_least(points, best))} would do ({where})"
    return Sentence(f"{who} fits into the memory of a PE: {least}.", (best,))


def _least(points: Points, number: int) -> int:
    """The least capacity that a point which does not fit would need; 0 if that is not known."""
    return max((row.get("least_bytes") or 0 for row in points.unfit[number]), default=0)


def fit_sentences(points: Points) -> Iterator[Sentence]:
    """What does not fit where, and how much it lacks."""
    for kind in (LACKS, STUCK, EXCEEDS):
        where: dict[str, dict[int, int]] = {}
        for case, place in enumerate(points.cases):
            for number in place:
                fit = fit_of(points, number)
                if fit and fit.kind == kind:
                    where.setdefault(points.flow(number), {})[case] = number
        alike: dict[tuple[int, ...], list[str]] = {}
        for flow, found in where.items():
            alike.setdefault(tuple(found), []).append(flow)
        for cases, flows in sorted(alike.items(), key=lambda of: -len(of[0])):
            numbers = [where[flow][case] for flow in flows for case in cases]
            yield Sentence(_told(points, kind, flows, numbers, len(cases)), tuple(numbers))


def _told(points: Points, kind: str, flows: list[str], numbers: list[int], n_cases: int) -> str:
    everyone = {points.flow(n) for n in range(len(points.profits))}
    is_all = len(flows) > 1 and everyone == set(flows)
    sizes = [fit.bytes for n in numbers if (fit := fit_of(points, n))]
    verb = {
        LACKS: "fits" if is_all else "does not fit" if len(flows) == 1 else "do not fit",
        STUCK: "came to no end",
        EXCEEDS: "held more than a PE has",
    }[kind]
    who = (
        ("nothing" if kind == LACKS else "every policy")
        if is_all
        else words.any_of(map(_called, flows), "and")
    )
    text = words.capital(f"{who} {verb}{_where(points, numbers, n_cases)}")
    if kind == STUCK:
        reason = next((f.reason for n in numbers if (f := fit_of(points, n)) and f.reason), "")
        return f"{text}, as no PE could go on{f': {reason}' if reason else ''}."
    by = {LACKS: "each PE lacks", EXCEEDS: "by"}[kind]
    return f"{text}{':' if kind == LACKS else ','} {by} {_span(sizes)}."


def _called(flow: str) -> str:
    """``"the replicated scene"``; dataflows have no article."""
    return f"the {flow}" if flow.endswith("scene") else flow


def _where(points: Points, numbers: list[int], n_cases: int) -> str:
    """``" in 3 of 5 cases (up to 16 PEs)"``; nothing where there is one case."""
    cases = [place[0] for place in points.cases]
    if len(cases) == 1:
        return ""
    if n_cases == len(cases):
        return f" in all {n_cases} cases ({extent(points, cases)})"
    found = region(points, numbers, cases)
    return f" in {n_cases} of {len(cases)} cases" + (f" ({found})" if found else "")


def _span(sizes: list[int]) -> str:
    """``"1.2 GB to 18 GB"``."""
    ends = dict.fromkeys(map(_rounded, (min(sizes), max(sizes))))
    return " to ".join(ends)


def _rounded(size_bytes: int) -> str:
    """With three digits: how much is lacking is for people."""
    return format_bytes(int(float(f"{size_bytes:.3g}")))
