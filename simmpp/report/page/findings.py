"""What a sweep says, in words and numbers: which policy wins where, by how much, how sure."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from statistics import median

from simmpp.common.units import format_ps
from simmpp.plot.curves import Spread
from simmpp.policy.parameters import REFERENCE
from simmpp.report.page.arrangement import abscissas, arrange
from simmpp.report.page.classical import FREE, Duel, duels_of
from simmpp.report.page.measures import ALL
from simmpp.run import words
from simmpp.sweeps.intervals import of_logarithms
from simmpp.sweeps.winners.contest import (
    ALONE,
    EQUAL,
    SURE,
    TOO_FEW_SEEDS,
    UNSURE,
    Contest,
    contests_of,
    replicated_policies,
)
from simmpp.sweeps.winners.points import Points
from simmpp.sweeps.winners.sentence import Sentence

TIME_PROFIT = ALL["time_profit"]


@dataclass(frozen=True)
class Win:
    """One dataflow that is the fastest at some places of one curve."""

    of: str
    """The curve, such as ``"mountain:5, 64 PEs"``."""
    winner: str
    where: str
    """Values of the abscissa."""
    places: int
    makespan: str
    lead: str
    """How long the next takes, and who that is."""
    sure: str
    points: tuple[int, ...]
    """Numbers of the points that say so."""


def further(points: Points) -> list[Sentence]:
    """What there is to know besides the answer, in a few lines."""
    return [*_best_gains(points), *_classical(points)]


def _best_gains(points: Points) -> Iterator[Sentence]:
    """Where each dataflow but the reference gains most and least."""
    no_flows = {REFERENCE, *replicated_policies(points)}
    found = {n: TIME_PROFIT.spread(points, n) for n in range(len(points.profits))}
    gains = {n: gain for n, gain in found.items() if gain is not None}
    for title in dict.fromkeys(row["policy"] for row in points.profits):
        own = {n: gain for n, gain in gains.items() if points.profits[n]["policy"] == title}
        if own and title not in no_flows:
            yield _gain(points, title, own)


def _gain(points: Points, title: str, gains: Mapping[int, Spread]) -> Sentence:
    best, worst = (of(gains, key=lambda n: gains[n].mean) for of in (max, min))
    gain, names = gains[best], list(points.axes)
    spread = f"95 % interval {gain.low:.3g} to {gain.high:.3g}" if gain.low < gain.high else ""
    where = _point(points, best, names)
    aside = "; ".join(filter(None, (where, spread)))
    text = f"{words.capital(words.policy(title))}: time profit {gain.mean:.3g}"
    text += f" ({aside})" if aside else ""
    if len(gains) == 1:
        return Sentence(text + ".", (best,))
    middle = median(of.mean for of in gains.values())
    where = _point(points, worst, names)
    text += f" at best, {middle:.3g} in the median, {gains[worst].mean:.3g} at worst ({where})."
    return Sentence(text, (best, worst))


def _classical(points: Points) -> Iterator[Sentence]:
    """The best classical way beside each dataflow that is none."""
    by_title: dict[str, list[Duel]] = {}
    for duel in duels_of(points):
        if not math.isnan(duel.ratio):
            by_title.setdefault(points.profits[duel.other]["policy"], []).append(duel)
    for title, duels in by_title.items():
        ways = Counter(words.policy(points.profits[duel.classical]["policy"]) for duel in duels)
        flow, times = words.policy(title), words.span(duel.ratio for duel in duels)
        free = [name for name in FREE if name in points.axes]
        beaten = sum(duel.ratio < 1 for duel in duels)
        if len(duels) == 1:
            (which,), how = ways, words.point(points.profits[duels[0].classical], free)
            where, end = f"{which} ({how})" if how else which, ""
        else:
            first, *others = (f"{way} in {number}" for way, number in ways.most_common())
            over = f" (over {', '.join(free)})" if free else ""
            where = f"{', '.join([f'{first} of {len(duels)} cases', *others])}{over}"
            end = f", less time in {beaten or 'none'}"
        text = f"With no more memory than {flow} the best classical way is {where}: {flow} takes"
        text += f" {times} times as long{end}{_not_run(duels)}."
        yield Sentence(text, tuple(duel.other for duel in duels))


def _not_run(duels: Sequence[Duel]) -> str:
    """Classical dataflows that are not among those that were compared."""
    counts = Counter(name for duel in duels for name in duel.absent)
    return "".join(
        f"; {words.policy(name)} was not run" + ("" if n == len(duels) else f" in {n} of them")
        for name, n in counts.items()
    )


def wins(points: Points) -> list[Win]:
    """A line for each dataflow that wins somewhere on a curve."""
    along = abscissas(points.axes)[0]
    curves: dict[str, list[Contest]] = {}
    arrangement = arrange(points.profits, points.axes, along)
    names = [name for name in points.axes if name in (*arrangement.plate_axes, arrangement.facet)]
    for contest in contests_of(points):
        of = words.point(points.profits[contest.best], names)
        curves.setdefault(of, []).append(contest)
    return [win for of, contests in curves.items() for win in _wins_of(points, of, contests, along)]


def _wins_of(points: Points, of: str, contests: Sequence[Contest], along: str) -> Iterator[Win]:
    by_winner: dict[str, list[int]] = {}
    for place, contest in enumerate(contests):
        by_winner.setdefault(_winner(points, contest), []).append(place)
    for winner, places in by_winner.items():
        won = [contests[place] for place in places]
        yield Win(
            of,
            winner,
            _where(points, contests, places, along),
            len(places),
            _makespans(points, won),
            _lead(points, won),
            _sure(won),
            tuple(contest.best for contest in won),
        )


def _makespans(points: Points, won: Sequence[Contest]) -> str:
    """The least and the greatest, each the geometric mean of its seeds."""
    of = [[row["makespan_ps"] for row in points.runs[contest.best]] for contest in won]
    ends = sorted(of_logarithms(seeds).mean for seeds in of)
    least, most = (format_ps(int(float(f"{end:.3g}"))) for end in (ends[0], ends[-1]))
    return least if least == most else f"{least} to {most}"


def _point(points: Points, number: int, names: Sequence[str]) -> str:
    return words.point({name: points.at(number, name) for name in names}, names)


def _winner(points: Points, contest: Contest) -> str:
    equal = contest.rivals if contest.certainty == EQUAL else ()
    return " = ".join(sorted(points.profits[n]["policy"] for n in (contest.best, *equal)))


def _where(points: Points, contests: Sequence[Contest], places: Sequence[int], along: str) -> str:
    """``"1.56 % to 40 %, 60 %"``: neighbours are joined, where they are numbers."""
    cells = [points.at(contests[place].best, along) for place in places]
    values = [words.value(along, cell) for cell in cells] if along != "policy" else [""]
    if not all(map(words.is_number, points.axes.get(along, [""]))):
        return ", ".join(values)
    runs = groupby(zip(values, places, range(len(places)), strict=True), lambda x: x[1] - x[2])
    ends = [[value for value, _, _ in run] for _, run in runs]
    return ", ".join(run[0] if len(run) == 1 else f"{run[0]} to {run[-1]}" for run in ends)


def _lead(points: Points, won: Sequence[Contest]) -> str:
    ahead = [
        contest for contest in won if contest.certainty != EQUAL and not math.isnan(contest.lead)
    ]
    seconds = {points.profits[contest.second or 0]["policy"] for contest in ahead}
    if not ahead:
        return ""
    longer = words.times_as_long(contest.lead for contest in ahead)
    return f"{longer} ({' or '.join(sorted(seconds))})"


def _sure(won: Sequence[Contest]) -> str:
    counts = Counter(contest.certainty for contest in won)
    if counts[TOO_FEW_SEEDS]:
        return "not known: too few seeds"
    if counts[EQUAL] == len(won):
        return "equal in every seed"
    if counts[ALONE] == len(won):
        return "nothing to compare with"
    if not counts[UNSURE]:
        return "beyond the 95 % interval" + (" at each" if len(won) > 1 else "")
    if counts[UNSURE] == len(won):
        return "no difference that these seeds can show"
    return f"beyond the 95 % interval at {counts[SURE]} of {len(won)}"
