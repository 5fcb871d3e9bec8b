"""Which machine finishes first and which is cheapest, in sentences, and all of them as a table.

A lead is sure where its 95 % interval, over the seeds that both have, lies above 1.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from simmpp.common.files import Row
from simmpp.common.units import counted, format_ps
from simmpp.run import words
from simmpp.sweeps.winners.contest import SURE, TOO_FEW_SEEDS, makespan_ratios, verdict
from simmpp.sweeps.winners.machines import Machines, Offer, Race
from simmpp.sweeps.winners.points import Points
from simmpp.sweeps.winners.sentence import Sentence

PREFIXES = (("M", 1e6), ("k", 1e3), ("", 1.0), ("m", 1e-3), ("u", 1e-6), ("n", 1e-9))


def seconds(ps: float) -> str:
    """``"1.23 ms"``."""
    return format_ps(round(float(f"{ps:.3g}")))


def energy(joules: float) -> str:
    """``"1.23 kJ"``."""
    prefix, size = next((of for of in PREFIXES if joules >= of[1]), PREFIXES[-1])
    return f"{joules / size:.3g} {prefix}J"


def price(amount: float) -> str:
    """``"3.4e-05"``: in whose currency only the machines' files know."""
    return f"{amount:.3g}"


class Measure(NamedTuple):
    """By what machines are compared: less is better."""

    column: str
    first: str
    """What is said of the best machine."""
    times: str
    """The next one takes so many times as ..."""
    of: Callable[[Offer], float | None]
    write: Callable[[float], str]


MEASURES = (
    Measure(
        *("makespan", "Of {n} machines {machine} finishes first", "long"),
        *(lambda offer: offer.makespan_ps, seconds),
    ),
    Measure(
        *("node-seconds", "The fewest node-seconds takes {machine}", "many"),
        *(lambda offer: offer.node_ps, seconds),
    ),
    Measure(
        *("energy", "The least energy takes {machine}", "much"),
        *(lambda offer: offer.joules, energy),
    ),
    Measure(
        *("price", "The lowest price has {machine}", "much"),
        *(lambda offer: offer.price, price),
    ),
)


class Lead(NamedTuple):
    """The best machine of a race, and the next."""

    best: Offer
    next: Offer
    ratio: float
    """Of the next to the best."""
    certainty: str
    """Of the least sure of all comparisons."""


def lead_of(points: Points, race: Race, measure: Measure) -> Lead | None:
    """Who is best in a race; None where not all machines say what is compared."""
    best: dict[str, Offer] = {}
    for offer in race.offers:
        if measure.of(offer) is None:
            return None
        rival = best.get(offer.machine)
        if rival is None or _value(measure, offer) < _value(measure, rival):
            best[offer.machine] = offer
    first, second, *_ = ranked = sorted(best.values(), key=lambda offer: _value(measure, offer))
    found = {_verdict(points, measure, first, other) for other in ranked[1:]}
    certainty = min(found, key=lambda of: (of == SURE, of != TOO_FEW_SEEDS))
    ratio = _value(measure, second) / _value(measure, first)
    return Lead(first, second, ratio, certainty)


def _value(measure: Measure, offer: Offer) -> float:
    return measure.of(offer) or 0.0


def _verdict(points: Points, measure: Measure, best: Offer, other: Offer) -> str:
    """Whether seeds can tell the two; what else is counted has one factor in all seeds."""
    factor = _value(measure, other) / other.makespan_ps / (_value(measure, best) / best.makespan_ps)
    ratios = [factor * ratio for ratio in makespan_ratios(points, other.point, best.point)]
    return verdict(ratios, points.confidence)


def machine_sentences(machines: Machines) -> Iterator[Sentence]:
    """A sentence for each measure that all machines know."""
    for measure in MEASURES:
        leads = [lead_of(machines.points, race, measure) for race in machines.races]
        known = [lead for lead in leads if lead is not None]
        if known and len(known) == len(leads):
            is_one = len(known) == 1
            text = _one(machines, measure, known[0]) if is_one else _many(machines, measure, known)
            yield Sentence(f"{text}.", tuple(lead.best.point for lead in known))


def _one(machines: Machines, measure: Measure, lead: Lead) -> str:
    points, (race,) = machines.points, machines.races
    nodes = counted(lead.best.processors, "PE")
    how = f"{measure.write(_value(measure, lead.best))} ({points.flow(lead.best.point)}, {nodes})"
    text = f"{measure.first.format(n=len(race.machines), machine=lead.best.machine)}: {how}"
    times = f"{lead.ratio:.3g} times as {measure.times}"
    return f"{text}; the next, {lead.next.machine}, takes {times}{_unsure([lead])}"


def _many(machines: Machines, measure: Measure, leads: Sequence[Lead]) -> str:
    counts = Counter(lead.best.machine for lead in leads).most_common()
    number = max(len(race.machines) for race in machines.races)
    (machine, most), *others = counts
    share = f"all {len(leads)}" if most == len(leads) else f"{most} of {len(leads)}"
    text = f"{measure.first.format(n=number, machine=machine)} in {share} cases"
    text += "".join(f", {other} in {count}" for other, count in others)
    times = f"{words.span(lead.ratio for lead in leads)} times as {measure.times}"
    return f"{text}; the next takes {times}{_unsure(leads)}"


def _unsure(leads: Sequence[Lead]) -> str:
    """Where seeds can't tell."""
    unsure = sum(lead.certainty != SURE for lead in leads)
    if not unsure:
        return ""
    if all(lead.certainty == TOO_FEW_SEEDS for lead in leads):
        return " (one seed)"
    where = "" if len(leads) == 1 else f" in {unsure} of them"
    return f", within what seeds can tell{where}"


def machine_table(machines: Machines) -> list[Row]:
    """A line for each machine and number of nodes, of each work."""
    known = [
        measure
        for measure in MEASURES
        if any(measure.of(offer) is not None for race in machines.races for offer in race.offers)
    ]
    return [
        {
            **({"of": race.of} if race.of else {}),
            "machine": offer.machine,
            "PEs": str(offer.processors),
            "fastest dataflow": machines.points.flow(offer.point),
            **{
                measure.column: "" if (value := measure.of(offer)) is None else measure.write(value)
                for measure in known
            },
        }
        for race in machines.races
        for offer in race.offers
    ]
