"""Who wins, in a sentence for those who have not read the paper; what it does not say follows.

*Fastest* is the dataflow with the least mean makespan (geometric, over common seeds). The sentence
claims a winner where the 95 % interval of its lead over each other dataflow lies above 1, or where
one seed is all there is, and then says so. Where seeds can't tell, it names those between whom.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

from simmpp.common.files import Row
from simmpp.common.units import counted
from simmpp.run import words
from simmpp.sweeps.winners.contest import (
    ALONE,
    EQUAL,
    SURE,
    UNSURE,
    Contest,
    contests_of,
    replicated_policies,
)
from simmpp.sweeps.winners.fitting import FITS, fit_of, fit_sentences, nothing_ran
from simmpp.sweeps.winners.machines import Machines
from simmpp.sweeps.winners.machines_told import machine_sentences
from simmpp.sweeps.winners.points import NO_LABELS, Points, points_of
from simmpp.sweeps.winners.sentence import Sentence
from simmpp.sweeps.winners.several import cases_of, few, shortest, told


def answer_of(
    rows: Sequence[Row], further: Sequence[str] = (), labels: Mapping[str, str] = NO_LABELS
) -> list[Sentence]:
    """Who wins, then the ceiling and what failed.

    ``rows`` are those of a ``results.csv``, with columns ``further`` of a sweep's keys; ``labels``
    name the policy of each label.
    """
    return answer(points_of(rows, tuple(further), labels=labels))


def answer(points: Points, machines: Machines | None = None) -> list[Sentence]:
    """The same of points, with their machines where they are compared."""
    contests = contests_of(points)
    if not contests:
        return [nothing_ran(points), *fit_sentences(points)]
    if all(contest.certainty == ALONE for contest in contests):
        text = f"Only {_flows(contests)} was run: there is nothing to compare it with."
        lines = [Sentence(text, tuple(cases_of(contests)))]
    elif len(contests) == 1:
        lines = [Sentence(f"{_one(points, contests[0])}.", (contests[0].best,))]
    else:
        of_machines = list(machine_sentences(machines)) if machines else []
        lines = [*told(points, contests), *(of_machines or shortest(points, contests))]
    lines += fit_sentences(points)
    return [*lines, *_absent(points, contests), *_ceiling(points, contests), *_failed(points)]


def _flows(contests: Sequence[Contest]) -> str:
    return words.any_of((flow for contest in contests for flow in contest.flows), "or")


# --- one case ---


def _one(points: Points, contest: Contest) -> str:
    best, *rivals = (points.flow(n) for n in (contest.best, *contest.rivals))
    longer, spread = words.times_as_long([contest.lead]), _spread(contest)
    next_one = points.flow(contest.second) if contest.second is not None else ""
    if contest.certainty == UNSURE:
        those = words.any_of([best, *rivals])
        return (
            f"Seeds can't tell who is fastest, {those}: on average it is {best}, and {next_one} "
            f"takes {longer} ({spread})"
        )
    if contest.certainty == EQUAL:
        return f"{words.capital(words.any_of([best, *rivals], 'and'))} are equally fast, to the ps"
    lead = f"; the next, {next_one}, takes {longer}" if longer else ""
    is_sure = contest.certainty == SURE
    how_sure = f" ({spread})" if is_sure else f"; how sure that is, {few(contest.seeds)} can't tell"
    return f"{points.taken(contest.best)} is fastest{lead}{how_sure}"


def _spread(contest: Contest) -> str:
    """The interval of the lead."""
    seeds = counted(contest.seeds, "seed")
    if contest.low == contest.high:
        return f"the same in all {seeds}"
    ends = words.times_as_long([contest.low, contest.high])
    return f"95 % interval {ends.removesuffix(' as long').removesuffix(' longer')}, {seeds}"


# --- what else must be said ---


def _absent(points: Points, contests: Sequence[Contest]) -> Iterator[Sentence]:
    """Dataflows that take part in some of the cases only, unless that is for want of memory."""
    counts = Counter(number for contest in contests for number in contest.flows)
    unfit = {points.flow(n) for n, rows in enumerate(points.unfit) if rows}
    missing = [
        f"{flow} has no result in {len(contests) - number}"
        for flow, number in sorted(counts.items())
        if number < len(contests) and flow not in unfit
    ]
    if missing:
        yield Sentence(f"{words.capital(', '.join(missing))} of {len(contests)} cases.")


def _ceiling(points: Points, contests: Sequence[Contest]) -> Iterator[Sentence]:
    """The replicated scene: it has more memory than the dataflows, unless these hold all too or a
    capacity says that it fits as they do."""
    found = [contest for contest in contests if contest.ceiling]
    fits = _places_for_the_scene(points)
    if fitting := [contest for contest in found if points.groups[contest.best] in fits]:
        where = (
            "" if len(fitting) == len(contests) else f" in {len(fitting)} of {len(contests)} cases"
        )
        room = f"the whole scene fits into the memory of a PE{where}: held there"
        yield _with_it(f"{room} (replicated, no dataflow)", fitting)
    found = [contest for contest in found if points.groups[contest.best] not in fits]
    if not found:
        return
    held = [_held(points, contest.best) for contest in found]
    scarce = [share for share in held if share < 1]
    if not scarce:
        room = "every memory has room for the whole scene: held there (replicated, no dataflow)"
    else:
        where = "" if len(scarce) == len(found) else f" in {len(scarce)} of {len(found)} cases"
        room = (
            "The whole scene in every memory (replicated, no dataflow) is the ceiling, not a choice"
            f"{where}: it does not fit, as it takes {words.span(1 / s for s in scarce)} times the "
            "memory for objects that the dataflows have. With it"
        )
    yield _with_it(room, found)


def _with_it(room: str, found: Sequence[Contest]) -> Sentence:
    """What the replicated scene takes there."""
    ratios = [1 / (contest.ceiling or 1) for contest in found]
    longer = sum(ratio > 1 for ratio in ratios)
    text = f"the job takes {words.span(ratios)} times as long as with the fastest dataflow"
    if len(found) > 1 and longer:
        text += f" (longer in {longer} of {len(found)} cases)"
    return Sentence(words.capital(f"{room} {text}."), tuple(cases_of(found)))


def _places_for_the_scene(points: Points) -> set[int]:
    """Where a capacity has room for the whole scene, and for all else that its policy needs."""
    policies = replicated_policies(points)
    numbers = (n for n, row in enumerate(points.profits) if row["policy"] in policies)
    fits = ((n, fit_of(points, n)) for n in numbers)
    return {points.groups[n] for n, fit in fits if fit and fit.kind == FITS}


def _held(points: Points, number: int) -> float:
    """The share of the objects that are in a PE's memory for good."""
    return min(row["effective_fraction"] for row in points.runs[number])


def _failed(points: Points) -> Iterator[Sentence]:
    missing = [n for n, runs in enumerate(points.runs) if not (runs or points.unfit[n])]
    if missing:
        names = words.any_of((points.flow(n) for n in missing), "and")
        text = f"{len(missing)} of {counted(len(points.runs), 'point')} failed ({names})."
        yield Sentence(text, tuple(missing))
