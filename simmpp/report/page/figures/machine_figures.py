"""Machines over each other: time over nodes, a line for each machine with its fastest dataflow."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import chain

from simmpp.plot.curves import Curve, Panel, Spread
from simmpp.report.page import scales
from simmpp.report.page.figures.figure import Figure
from simmpp.report.page.figures.profit_figures import scale_of
from simmpp.report.page.measures import ALL, unit_of
from simmpp.run import words
from simmpp.sweeps.winners.machines import Machines, Race

MEASURES = {"makespan": "Time over nodes", "node_seconds": "Node-seconds over nodes"}
STEMS = tuple(f"machines-{name.replace('_', '-')}" for name in MEASURES)
NOTE = "a line is a machine with the dataflow that is the fastest at each number of nodes"


def machine_figures(machines: Machines) -> Iterator[Figure]:
    """What the work takes in time and in node-seconds; none where machines are not compared."""
    names = dict.fromkeys(chain(*(race.machines for race in machines.races)))
    styles = {name: style for style, name in enumerate(names)}
    for stem, (name, title) in zip(STEMS, MEASURES.items(), strict=True):
        if styles:
            plates = {race.of: [_panel(machines, race, name, styles)] for race in machines.races}
            yield Figure(stem, title, f"{ALL[name].meaning}; {NOTE}", plates)


def _panel(machines: Machines, race: Race, name: str, styles: Mapping[str, int]) -> Panel:
    """The curves of one work."""
    points, measure = machines.points, ALL[name]
    found = {of.point: measure.spread(points, of.point) for of in race.offers}
    known = {number: spread for number, spread in found.items() if spread is not None}
    unit, size = unit_of(measure, (spread.mean for spread in known.values()))
    curves = []
    for machine in race.machines:
        rows = {
            float(of.processors): of.point
            for of in race.offers
            if of.machine == machine and of.point in known
        }
        spreads = {x: Spread(*(end / size for end in known[n])) for x, n in rows.items()}
        flows = words.any_of((points.flow(n) for _, n in sorted(rows.items())), "then")
        curves.append(Curve(f"{machine}: {flows}", spreads, style=styles[machine], rows=rows))
    x, _ = scales.abscissa("processors", sorted({of.processors for of in race.offers}))
    label = words.uncapital(measure.title) + (f" ({unit})" if unit else "")
    return Panel(race.of, x, scale_of(label, curves), curves)
