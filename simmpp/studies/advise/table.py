"""``advise.csv``: a row for each candidate, whatever became of it."""

from __future__ import annotations

from collections.abc import Iterator

from simmpp.common.files import Row
from simmpp.studies.advise.advice import Advice

FILE = "advise.csv"
CANNOT_WIN = "can't win"
COLUMNS = (
    "candidate",
    "processors",
    "policy",
    "advised",
    "fate",
    "seeds",
    "makespan_ps",
    "makespan_low_ps",
    "makespan_high_ps",
    "bound_ps",
    "fits",
    "least_bytes",
    "lacking_bytes",
    "as_good",
    "regret",
)
"""``fate``: in the end, left behind, can't win (its bound says so), not needed (fewer nodes do),
untried (broken off), no end, does not fit. ``as_good``: how likely it is as good as the best;
``regret``: by what share it takes more than the best, in the mean."""


def rows_of(advice: Advice) -> list[Row]:
    """By nodes, then the simplest first."""
    numbers = {id(candidate): n for n, candidate in enumerate(advice.fitting)}
    rows = []
    for candidate in advice.candidates:
        row: Row = dict.fromkeys(COLUMNS, "")
        row |= {
            "candidate": candidate.setup.name,
            "processors": candidate.processors,
            "policy": candidate.policy.title,
            "advised": int(candidate is advice.chosen),
            "fate": "does not fit",
            "fits": int(candidate.fits),
            "least_bytes": candidate.least_bytes,
            "lacking_bytes": candidate.lacking_bytes,
        }
        if candidate.fits:
            row |= dict(_found(advice, numbers[id(candidate)]))
        rows.append(row)
    return rows


def _found(advice: Advice, number: int) -> Iterator[tuple[str, object]]:
    race, verdict = advice.contest.race, advice.verdict
    yield "bound_ps", advice.bounds[number]
    yield "fate", fate(advice, number)
    if number not in race.costs:
        return
    yield "seeds", len(race.costs[number])
    found = advice.makespan_ps(number)
    for name, value in zip(("", "low_", "high_"), found, strict=True):
        if value < float("inf"):
            yield f"makespan_{name}ps", round(value)
    if number in verdict.likely:
        yield "as_good", verdict.likely[number]
        yield "regret", verdict.regret[number]


def fate(advice: Advice, number: int) -> str:
    """What became of one that fits."""
    race = advice.contest.race
    if number in race.costs:
        ended = race.mean(number) < float("inf")
        return ("in the end" if number in race.in_race else "left behind") if ended else "no end"
    if number in race.dropped:
        return CANNOT_WIN
    return "not needed" if race.is_over else "untried"
