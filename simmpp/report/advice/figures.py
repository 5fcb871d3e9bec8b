"""The pictures of an advice: time over nodes, who wins with which memory, what it hangs on."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace

from simmpp.common.units import format_bytes
from simmpp.plot.curves import (
    Curve,
    Drawable,
    Layer,
    Panel,
    Scale,
    Spread,
    Tile,
    Tiles,
)
from simmpp.report.page.figures.figure import Figure
from simmpp.run import words
from simmpp.studies.advise.advice import Advice
from simmpp.studies.advise.memory_map import Place
from simmpp.studies.advise.sensitivity import Swing
from simmpp.studies.advise.told import named, rounded_time

PS_PER_MS = 1e9
CONSTANTS = 6
"""Of the constants, those that move the advice most."""
NOTHING = "nothing fits"
ABOVE = 1.4
"""How far above the curves is told what does not fit, as a factor."""
BESIDE = 1.1
"""Room on both sides of a tornado, as a factor."""
RATIOS = (0.05, 0.1, 0.2, 0.5, 0.8, 0.9, 1.0, 1.1, 1.2, 1.5, 2.0, 5.0, 10.0, 20.0)
"""Ticks of its axis."""
HAIR = 1e-6
"""Of a vertical line, as curves are over their abscissas."""


def advice_figures(advice: Advice, places: list[Place]) -> Iterator[tuple[str, Figure]]:
    """Each picture with the sentence that it shows."""
    times = _times(advice)
    if times is not None:
        yield _said_of_times(advice), times
    if places:
        yield _said_of_map(advice, places), _map(places)
    if advice.sensitivity.swings:
        yield _said_of_swings(advice), _swings(advice)


# --- time over nodes ---


def _times(advice: Advice) -> Figure | None:
    race, styles = advice.contest.race, _styles(advice)
    best: dict[str, dict[int, int]] = {}
    for number, candidate in enumerate(advice.fitting):
        if number in race.costs and math.isfinite(race.mean(number)):
            at = best.setdefault(candidate.policy.name, {})
            other = at.get(candidate.processors)
            if other is None or race.mean(number) < race.mean(other):
                at[candidate.processors] = number
    if not best:
        return None
    curves = [
        Curve(
            words.policy(policy),
            {float(nodes): _spread(advice, number) for nodes, number in sorted(at.items())},
            style=styles[policy],
        )
        for policy, at in sorted(best.items())
    ]
    bounds = {each.processors: b for each, b in zip(advice.fitting, advice.bounds, strict=True)}
    least = {float(nodes): Spread(*(bound / PS_PER_MS,) * 3) for nodes, bound in bounds.items()}
    curves.append(Curve("computing alone", dict(sorted(least.items())), is_guide=True))
    heights = [spread.mean for curve in curves for spread in curve.points.values()]
    sizes = tuple(float(n) for n in sorted({each.processors for each in advice.candidates}))
    curves += _unfit(advice, max(heights), styles)
    x = Scale("nodes (PEs)", is_log=True, ticks=sizes)
    panel = Panel("", x, Scale("makespan (ms)", is_log=True), curves)
    note = (
        "of each policy the best candidate that was simulated; bands: 95 % interval over seeds;"
        " on top: where nothing of a policy fits; elsewhere, where a point is missing, none can win"
    )
    return Figure("advice-times", "Time over nodes", note, {"": [panel]})


def _spread(advice: Advice, number: int) -> Spread:
    found = advice.makespan_ps(number)
    ends = [found.mean if math.isnan(end) else end for end in (found.low, found.high)]
    return Spread(*(value / PS_PER_MS for value in (found.mean, *ends)))


def _unfit(advice: Advice, height: float, styles: dict[str, int]) -> Iterator[Curve]:
    """Above all curves, a row for each policy of which nothing fits somewhere."""
    fits: dict[str, dict[int, bool]] = {}
    for each in advice.candidates:
        sizes = fits.setdefault(each.policy.name, {})
        sizes[each.processors] = sizes.get(each.processors, False) or each.fits
    for policy, sizes in fits.items():
        unfit = sorted(nodes for nodes, does in sizes.items() if not does)
        if unfit:
            height *= ABOVE
            points = {float(nodes): Spread(height, height, height) for nodes in unfit}
            yield Curve(f"{words.policy(policy)}: does not fit", points, style=styles[policy])


def _said_of_times(advice: Advice) -> str:
    number = advice.verdict.chosen
    if number is None:
        return "Nothing came to an end."
    takes = rounded_time(advice.makespan_ps(number).mean)
    return f"{words.capital(named(advice.fitting[number]))} takes {takes}."


# --- who wins with which memory ---


def _map(places: list[Place]) -> Figure:
    sizes = sorted({place.capacity_bytes for place in places})
    nodes = sorted({place.processors for place in places})
    layers: dict[str, list[Tile]] = {}
    policies: dict[str, str] = {}
    for place in places:
        at = sizes.index(place.capacity_bytes), nodes.index(place.processors)
        label, text = NOTHING, NOTHING
        if place.best is not None:
            label = words.policy(place.best.policy.name)
            policies[label] = place.best.policy.name
            text = f"{named(place.best)}: {rounded_time(place.makespan_ps)}"
        where = f"{format_bytes(place.capacity_bytes)} a node, {place.processors} nodes"
        layers.setdefault(label, []).append(Tile(*at, -1, f"{where}: {text}"))
    styles = {label: _style(name) for label, name in policies.items()}
    tiles = Tiles(
        "",
        _names("memory of a node", map(format_bytes, sizes)),
        _names("nodes (PEs)", map(str, nodes)),
        [Layer(label, styles.get(label), of) for label, of in sorted(layers.items())],
    )
    plates: dict[str, list[Drawable]] = {"": [tiles]}
    note = "one seed, of the setups that were best on as many nodes and those that fit only there"
    return Figure("advice-map", "Who would win with other memory", note, plates)


def _names(label: str, names: Iterable[str]) -> Scale:
    texts = tuple(names)
    return Scale(label, ticks=tuple(map(float, range(len(texts)))), names=texts)


def _said_of_map(advice: Advice, places: list[Place]) -> str:
    winners = {place.best.policy.name for place in places if place.best is not None}
    empty = sum(place.best is None for place in places)
    flows = words.any_of(map(words.policy, sorted(winners)), "and")
    text = f"With a quarter to four times the memory {flows or 'nothing'}"
    text += " wins everywhere" if len(winners) == 1 else " win somewhere"
    return f"{text}; at {empty} of {len(places)} places nothing fits." if empty else f"{text}."


# --- what it hangs on ---


def _swings(advice: Advice) -> Figure:
    """A tornado: a bar for each constant, the one that moves most on top."""
    shown = advice.sensitivity.swings[:CONSTANTS][::-1]
    curves = [_bar(float(n), swing) for n, swing in enumerate(shown)]
    beside = {1 - HAIR: Spread(*(-0.5,) * 3), 1 + HAIR: Spread(*(len(shown) - 0.5,) * 3)}
    curves.append(Curve("a rival is as good", beside, is_guide=True))
    ratios = [ratio for curve in curves for ratio in curve.points]
    ends = min(ratios) / BESIDE, max(ratios) * BESIDE
    ticks = tuple(tick for tick in RATIOS if ends[0] <= tick <= ends[1])
    x = Scale("best rival's cost / the advised one's", is_log=True, ticks=ticks, limits=ends)
    y = _names("constant of the machine", [swing.constant.name for swing in shown])
    y = replace(y, limits=(-0.7, len(shown) - 0.3))
    note = "left of 1 a rival is better; one seed, one constant at a time, from end to end"
    panel = Panel("", x, y, curves)
    return Figure("advice-constants", "What the advice hangs on", note, {"": [panel]})


def _bar(height: float, swing: Swing) -> Curve:
    """From the constant's least value to its greatest."""
    ends = {_ratio(swing.advantages[end]): _end(swing, end) for end in (0, 1)}
    if len(ends) == 1:  # it moves nothing
        ends = dict.fromkeys(ends, f"{_end(swing, 0)} to {_end(swing, 1)}")
    points = {ratio: Spread(height, height, height) for ratio in sorted(ends)}
    return Curve("from its least to its greatest value", points, notes=ends)


def _ratio(advantage: float) -> float:
    """Within what can be drawn."""
    return math.exp(max(-3.0, min(3.0, advantage)))


def _end(swing: Swing, end: int) -> str:
    value = (swing.constant.low, swing.constant.high)[end]
    return swing.constant.text(value)


def _said_of_swings(advice: Advice) -> str:
    swings = advice.sensitivity.swings
    turning = [s.constant.name for s in swings if any(at is not None for at in s.turns_at)]
    if turning:
        return f"The advice hangs on {words.any_of(turning, 'and')}."
    return "No constant alone changes the advice within its range."


def _styles(advice: Advice) -> dict[str, int]:
    return {each.policy.name: _style(each.policy.name) for each in advice.candidates}


def _style(policy: str) -> int:
    """A policy's colour, as on all pages; of one's own the next."""
    known = list(words.PAPER_WORDS)
    return known.index(policy) if policy in known else len(known)
