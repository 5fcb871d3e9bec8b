"""Which policy wins over capacity and number of PEs; what does not fit is a region of the map."""

from __future__ import annotations

from collections.abc import Iterator

from simmpp.plot.curves import Layer, Scale, Tile, Tiles
from simmpp.report.page import scales
from simmpp.report.page.figures.figure import Figure, styles_of
from simmpp.run import words
from simmpp.run.words import CAPACITY
from simmpp.sweeps.winners.contest import EQUAL, UNSURE, Contest, contests_of
from simmpp.sweeps.winners.fitting import fit_of
from simmpp.sweeps.winners.points import Points

NOTHING = "nothing fits"
NOTE = "the dataflow with the least makespan, of those that fit; hatched: none does"
PROCESSORS = "processors"


def capacity_map(points: Points, stem: str) -> Iterator[Figure]:
    """The winner of each case, with the capacity along and PEs upwards; none without both axes'
    values, of which one may be the only one."""
    axes = [name for name in (CAPACITY, PROCESSORS) if name in points.axes]
    if not axes:
        return
    across, *rest = axes
    up = rest[0] if rest else ""
    others = [name for name in points.axes if name not in axes]
    contests = {points.groups[contest.best]: contest for contest in contests_of(points)}
    plates: dict[str, list[int]] = {}
    for group, place in enumerate(points.places):
        if group in contests or any(points.unfit[n] for n in place):
            of = words.point(points.profits[place[0]], others)
            plates.setdefault(of, []).append(group)
    tiles = {
        plate: [_tiles(points, plate, groups, contests, across, up)]
        for plate, groups in plates.items()
    }
    yield Figure(stem, "Which policy wins, and where nothing fits", NOTE, tiles)


def _tiles(
    points: Points,
    title: str,
    groups: list[int],
    contests: dict[int, Contest],
    across: str,
    up: str,
) -> Tiles:
    styles = {words.policy(name): style for name, style in styles_of(points.profits).items()}
    xs, ys = points.axes[across], points.axes.get(up, [""])
    layers: dict[str, list[Tile]] = {}
    for group in groups:
        number = points.places[group][0]
        row, contest = points.profits[number], contests.get(group)
        best = contest.best if contest else number
        place = xs.index(row[across]), ys.index(row[up]) if up else 0
        text = "; ".join(filter(None, (_said(points, number, across, up), _aside(points, group))))
        label = points.flow(best) if contest else NOTHING
        if contest and contest.certainty in (UNSURE, EQUAL):
            text += ": others are as fast, as far as seeds can tell"
        layers.setdefault(label, []).append(Tile(*place, best, text))
    ordered = sorted(layers, key=lambda label: styles.get(label, len(styles) + 99))
    return Tiles(
        title,
        _scale(across, xs),
        _scale(up, ys),
        [Layer(label, styles.get(label), layers[label]) for label in ordered],
    )


def _scale(name: str, values: list[object]) -> Scale:
    ticks = tuple(map(float, range(len(values))))
    names = tuple(scales.label(name, cell) if name else "" for cell in values)
    titles = {CAPACITY: "memory of a PE", PROCESSORS: "processing elements (PEs)"}
    return Scale(titles.get(name, name), ticks=ticks, names=names)


def _said(points: Points, number: int, *names: str) -> str:
    return words.point(points.profits[number], filter(None, names))


def _aside(points: Points, group: int) -> str:
    """What does not fit there."""
    told = ((points.flow(n), fit_of(points, n)) for n in points.places[group] if points.unfit[n])
    return "; ".join(f"{flow} {fit}" for flow, fit in told)
