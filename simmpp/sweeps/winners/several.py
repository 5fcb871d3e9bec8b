"""The cases of a sweep in one sentence."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from simmpp.common.units import format_ps
from simmpp.run import words
from simmpp.sweeps.intervals import of_logarithms
from simmpp.sweeps.winners.contest import EQUAL, SURE, TOO_FEW_SEEDS, UNSURE, Contest
from simmpp.sweeps.winners.points import Points
from simmpp.sweeps.winners.regions import deciding_axes, extent, region
from simmpp.sweeps.winners.sentence import Sentence

MOSTLY = 0.75
"""Share of the cases from which one winner is what one should take."""
OTHER_WORK = ("scene", "picture", "folder", "method", "point")
"""Keys by which cases are not the same work, or not told by the same means."""


def told(points: Points, contests: Sequence[Contest]) -> Iterator[Sentence]:
    """Who wins, where, by how much and how sure that is; then where nobody wins."""
    won: dict[str, list[Contest]] = {}
    for contest in contests:
        if contest.certainty in (SURE, TOO_FEW_SEEDS):
            won.setdefault(points.flow(contest.best), []).append(contest)
    ranked = sorted(won.values(), key=len, reverse=True)
    if ranked:
        of_all = [contest for of in ranked for contest in of]
        text = "; ".join([", ".join(_winners(points, ranked, contests)), *_lead(points, of_all)])
        yield Sentence(f"{text}.", tuple(cases_of(of_all)))
    for certainty in (UNSURE, EQUAL):
        if some := [contest for contest in contests if contest.certainty == certainty]:
            yield Sentence(_open(points, some, contests), tuple(cases_of(some)))


def _winners(
    points: Points, ranked: Sequence[Sequence[Contest]], contests: Sequence[Contest]
) -> Iterator[str]:
    """Who is fastest in how many cases, and where these lie; what to do, if that is one thing."""
    first, *others = ranked
    best, decides = points.flow(first[0].best), _decides(points, ranked) if others else {}
    causes = [name for name, is_one in decides.items() if is_one]
    if _is_best_choice(points, best, first, contests):
        beginning = points.taken(first[0].best)
    elif others:
        beginning = f"Who wins {_causes(decides)}: {best}"
    else:
        beginning = words.capital(best)
    yield f"{beginning} is fastest in {_share(points, first, contests, causes)}"
    for won in others:
        yield f"{points.flow(won[0].best)} in {len(won)}{_where(points, won, contests, causes)}"


def _is_best_choice(
    points: Points, flow: str, won: Sequence[Contest], contests: Sequence[Contest]
) -> bool:
    """It wins mostly, or somewhere and nowhere is another known to be faster."""
    lost = [c for c in contests if flow not in _foremost(points, c)]
    return len(won) >= MOSTLY * len(contests) or not lost


def _foremost(points: Points, contest: Contest) -> list[str]:
    """The fastest, and those that seeds can't tell from it."""
    return [points.flow(number) for number in (contest.best, *contest.rivals)]


def _decides(points: Points, ranked: Sequence[Sequence[Contest]]) -> dict[str, bool]:
    """Whether an axis decides who wins, as far as cases tell."""
    winners = {contest.best: points.flow(contest.best) for won in ranked for contest in won}
    return deciding_axes(points, winners)


def _causes(decides: Mapping[str, bool]) -> str:
    """What decides who wins, and what does not."""
    named = {
        is_one: [words.CAUSES.get(name, name) for name in decides if decides[name] == is_one]
        for is_one in (True, False)
    }
    if not named[True]:
        return "differs from case to case"
    apart = f", not on {words.any_of(named[False])}" if named[False] else ""
    return f"depends on {words.any_of(named[True], 'and')}{apart}"


def _share(
    points: Points,
    won: Sequence[Contest],
    contests: Sequence[Contest],
    causes: Iterable[str] = (),
) -> str:
    """``"all 5 cases (4 to 64 PEs)"``, ``"3 of 5 cases (up to 16 PEs)"``."""
    if len(won) < len(contests):
        return f"{len(won)} of {len(contests)} cases{_where(points, won, contests, causes)}"
    number = "both" if len(contests) == 2 else f"all {len(contests)}"
    return f"{number} cases{_aside(extent(points, cases_of(contests)))}"


def _where(
    points: Points,
    some: Sequence[Contest],
    contests: Sequence[Contest],
    causes: Iterable[str] = (),
) -> str:
    return _aside(region(points, cases_of(some), cases_of(contests), causes))


def cases_of(contests: Sequence[Contest]) -> list[int]:
    """Points that stand for the cases."""
    return [contest.best for contest in contests]


def _aside(text: str) -> str:
    return f" ({text})" if text else ""


def shortest(points: Points, contests: Sequence[Contest]) -> Iterator[Sentence]:
    """The least makespan of all cases, where these are of one picture."""
    if len(contests) < 2 or any(name.split(".")[0] in OTHER_WORK for name in points.axes):
        return
    mean_ps = {
        n: of_logarithms([row["makespan_ps"] for row in points.runs[n]]).mean
        for n in cases_of(contests)
    }
    best = min(mean_ps, key=lambda number: mean_ps[number])
    where = ", ".join(words.values(name, [points.at(best, name)]) for name in points.axes)
    most = max(points.profits[n]["processors"] for n in mean_ps)
    more = "; on more PEs it takes longer" if points.profits[best]["processors"] < most else ""
    time = format_ps(int(float(f"{mean_ps[best]:.3g}")))
    yield Sentence(f"The shortest time is {time}: {points.flow(best)}, {where}{more}.", (best,))


def _lead(points: Points, won: Sequence[Contest]) -> Iterator[str]:
    """Who comes next, by how much, and how sure that is."""
    nexts = words.any_of(points.flow(c.second) for c in won if c.second is not None)
    name = f", {nexts}," if len({points.flow(c.best) for c in won}) == 1 else ""
    longer = words.times_as_long(contest.lead for contest in won)
    unsure = [contest for contest in won if contest.certainty == TOO_FEW_SEEDS]
    if longer:
        yield f"the next{name} takes {longer}" + ("" if unsure else _sure(won))
    if unsure:
        where = "" if len(unsure) == len(won) else f" in {len(unsure)} of them"
        yield f"how sure that is{where}, {few(max(c.seeds for c in unsure))} can't tell"


def _sure(won: Sequence[Contest]) -> str:
    seeds = words.span(contest.seeds for contest in won)
    return f", in each case beyond chance (95 % intervals, {seeds} seeds)"


def _open(points: Points, some: Sequence[Contest], contests: Sequence[Contest]) -> str:
    """Where nobody wins, for seeds can't tell or two are equal."""
    those = [name for contest in some for name in _foremost(points, contest)]
    share = _share(points, some, contests)
    if some[0].certainty == EQUAL:
        return f"In {share} {words.any_of(those, 'and')} are equally fast."
    longer = words.times_as_long(contest.lead for contest in some)
    return (
        f"In {share} seeds can't tell who is fastest, {words.any_of(those)} "
        f"(on average the next takes {longer})."
    )


def few(seeds: int) -> str:
    """Who can't tell."""
    return "one seed" if seeds == 1 else "these seeds"
