"""The pictures of an advice: time over nodes, who wins with which memory, what it hangs on."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from simmpp.common.units import format_bytes, format_ps
from simmpp.plot.curves import (
    Curve,
    Drawable,
    Hatched,
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
from simmpp.studies.advise.answer import named
from simmpp.studies.advise.memory_map import Place
from simmpp.studies.advise.sensitivity import Swing

PS_PER_MS = 1e9
CONSTANTS = 6
"""Of the constants, those that move the advice most."""
NOTHING = "nothing fits"
MARGIN = 1.12
"""Half of a hatched strip's width, as a factor."""


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
            notes={float(nodes): advice.fitting[n].setup.name for nodes, n in at.items()},
        )
        for policy, at in sorted(best.items())
    ]
    bounds = {each.processors: b for each, b in zip(advice.fitting, advice.bounds, strict=True)}
    least = {float(nodes): Spread(*(bound / PS_PER_MS,) * 3) for nodes, bound in bounds.items()}
    curves.append(Curve("computing alone", dict(sorted(least.items())), is_guide=True))
    heights = [spread.mean for curve in curves for spread in curve.points.values()]
    sizes = tuple(float(n) for n in sorted({each.processors for each in advice.candidates}))
    strips = list(_strips(advice, min(heights), max(heights), styles))
    x = Scale("nodes (PEs)", is_log=True, ticks=sizes)
    panel = Panel("", x, Scale("makespan (ms)", is_log=True), curves, hatched=strips)
    note = (
        "of each policy the best candidate that was simulated; bands: 95 % interval over seeds;"
        " hatched: nothing of that policy fits"
    )
    return Figure("advice-times", "Time over nodes", note, {"": [panel]})


def _spread(advice: Advice, number: int) -> Spread:
    found = advice.makespan_ps(number)
    ends = [found.mean if math.isnan(end) else end for end in (found.low, found.high)]
    return Spread(*(value / PS_PER_MS for value in (found.mean, *ends)))


def _strips(advice: Advice, low: float, high: float, styles: dict[str, int]) -> Iterator[Hatched]:
    fits: dict[tuple[str, int], bool] = {}
    for each in advice.candidates:
        key = each.policy.name, each.processors
        fits[key] = fits.get(key, False) or each.fits
    for (policy, nodes), does in fits.items():
        if not does:
            label = words.policy(policy)
            yield Hatched(nodes / MARGIN, nodes * MARGIN, low, high, label, styles[policy])


def _said_of_times(advice: Advice) -> str:
    chosen = advice.chosen
    if chosen is None:
        return "Nothing came to an end."
    number = advice.verdict.chosen
    assert number is not None
    return f"{words.capital(named(chosen))} takes {_time(advice.makespan_ps(number).mean)}."


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
            text = f"{named(place.best)}: {_time(place.makespan_ps)}"
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
    shown = advice.sensitivity.swings[:CONSTANTS]
    names = tuple(swing.constant.name for swing in shown)
    curves = [
        Curve(
            f"at its {word}",
            {float(n): Spread(*(_ratio(s.advantages[end]),) * 3) for n, s in enumerate(shown)},
            notes={float(n): _end(swing, end) for n, swing in enumerate(shown)},
        )
        for end, word in enumerate(("least", "greatest"))
    ]
    y = Scale("best rival's cost / the advised one's", is_log=True)
    panel = Panel("", _names("constant of the machine", names), y, curves, level=1.0)
    note = "below 1 a rival is better; one seed, one constant at a time, at both ends of its range"
    return Figure("advice-constants", "What the advice hangs on", note, {"": [panel]})


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


def _time(time_ps: float) -> str:
    return format_ps(int(float(f"{time_ps:.3g}")))
