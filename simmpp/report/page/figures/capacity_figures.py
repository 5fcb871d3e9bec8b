"""Memory that ends: who wins where, makespans with what does not fit, parts of the fullest PE."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain, pairwise
from statistics import fmean

from simmpp.common.files import Row
from simmpp.common.units import SIZES
from simmpp.plot.curves import LOG_MARGIN, Bars, Curve, Hatched, Panel, Scale, Spread
from simmpp.report.page import scales
from simmpp.report.page.arrangement import abscissas, arrange, plates
from simmpp.report.page.figures.bar_figures import bar_figure
from simmpp.report.page.figures.capacity_map import capacity_map
from simmpp.report.page.figures.figure import Figure, styles_of
from simmpp.report.page.measures import ALL, unit_of
from simmpp.run import words
from simmpp.run.words import CAPACITY
from simmpp.sweeps.winners.fitting import LACKS, STUCK, fit_of
from simmpp.sweeps.winners.points import Points

STEMS = MAP_STEM, MAKESPAN_STEM, PARTS_STEM = (
    "capacity-map",
    "makespan-by-capacity",
    "memory-of-the-fullest",
)
PARTS = {
    "objects for good": "peak_resident",
    "fetched objects": "peak_fetched",
    "rays": "peak_ray_queue",
    "rays received": "peak_receive",
}
"""What lies in the memory of the PE that ever held most, and its column."""
STRIP = 0.06
"""Height of the strip of what does not fit, as a share of the curves' height."""
LEAST_RATIO = 4.0
"""Of the ends of an axis of makespans, so that strips have a height."""


def capacity_figures(points: Points) -> Iterator[Figure]:
    """None where memory has no end."""
    if not any(fit_of(points, number) for number in range(len(points.profits))):
        return
    along = CAPACITY if CAPACITY in points.axes else abscissas(points.axes)[0]
    yield from capacity_map(points, MAP_STEM)
    if along in points.axes:
        yield _makespans(points, along)
    if any(map(_parts, points.runs)):
        yield _fullest(points, along)


def _parts(runs: Sequence[Row]) -> dict[str, float]:
    """Bytes of each part, means over seeds; none where memory has no end."""
    known = [row for row in runs if row.get(PARTS["rays"], "") != ""]
    return {part: fmean(row[c] for row in known) for part, c in PARTS.items()} if known else {}


def _fullest(points: Points, along: str) -> Figure:
    parts = [_parts(runs) for runs in points.runs]
    unit, size = scales.unit_of(SIZES, (sum(of.values()) for of in parts))
    figure = bar_figure(
        points,
        PARTS_STEM,
        "Memory of the fullest PE",
        "its parts at the instant at which any PE held most, means over seeds; rays are those that "
        "started and received ones may become; one request of each PE and the room of the escape "
        "come on top",
        f"memory ({unit})",
        lambda number: {part: height / size for part, height in parts[number].items()},
        along,
    )
    ran = {
        plate: [panel for panel in panels if isinstance(panel, Bars) and panel.rows]
        for plate, panels in figure.plates.items()
    }  # nothing is known of the memory of what does not fit
    return replace(figure, plates={plate: panels for plate, panels in ran.items() if panels})


def _makespans(points: Points, along: str) -> Figure:
    """A curve for each policy, and a strip where it does not fit."""
    arrangement = arrange(points.profits, points.axes, along)
    panels_of = {
        plate: [_panel(points, title, numbered, along) for title, numbered in panels.items()]
        for plate, panels in plates(points.profits, arrangement).items()
    }
    note = f"{ALL['makespan'].meaning}; hatched in its colour: there a policy does not fit"
    if words.UNBOUNDED in points.axes[along]:
        note += "; dotted: unbounded memory"
    title = f"Makespan over {words.ALONG.get(along, along)}, and what does not fit"
    return Figure(MAKESPAN_STEM, title, note, panels_of)


def _panel(points: Points, title: str, numbered: Sequence[tuple[int, Row]], along: str) -> Panel:
    measure = ALL["makespan"]
    values = [cell for cell in points.axes[along] if along != CAPACITY or words.is_number(cell)]
    x, places = scales.abscissa(along, values)
    found = {n: measure.spread(points, n) for n, _ in numbered}
    spreads = {n: spread for n, spread in found.items() if spread is not None}
    unit, size = unit_of(measure, (spread.mean for spread in spreads.values()))
    curves: list[Curve] = []
    unfit: dict[str, list[float]] = {}
    for policy, style in styles_of(points.profits).items():
        of = {row[along]: n for n, row in numbered if row["policy"] == policy}
        scaled = {c: Spread(*(e / size for e in spreads[n])) for c, n in of.items() if n in spreads}
        rows = {places[cell]: of[cell] for cell in scaled if cell in places}
        if along == CAPACITY and words.UNBOUNDED in scaled and places:
            level = dict.fromkeys(places.values(), scaled[words.UNBOUNDED])
            curves.append(Curve(words.policy(policy), level, is_guide=True))
        if rows:
            points_of = {places[cell]: scaled[cell] for cell in scaled if cell in places}
            curves.append(Curve(words.policy(policy), points_of, style=style, rows=rows))
        unfit[policy] = [places[c] for c, n in of.items() if c in places and _is_unfit(points, n)]
    y, strips = _scale_and_strips(
        f"makespan ({unit})", curves, unfit, styles_of(points.profits), sorted(places.values())
    )
    return Panel(title, x, y, curves, hatched=strips)


def _is_unfit(points: Points, number: int) -> bool:
    fit = fit_of(points, number)
    return fit is not None and fit.kind in (LACKS, STUCK)


def _scale_and_strips(
    label: str,
    curves: Sequence[Curve],
    unfit: Mapping[str, Sequence[float]],
    styles: Mapping[str, int],
    places: Sequence[float],
) -> tuple[Scale, list[Hatched]]:
    """A logarithmic scale with room below the curves, and there a strip for each policy."""
    spreads = list(chain(*(curve.points.values() for curve in curves)))
    low = min((spread.low for spread in spreads), default=1.0) / LOG_MARGIN
    high = max((spread.high for spread in spreads), default=1.0) * LOG_MARGIN
    high = max(high, low * LEAST_RATIO)
    factor, strips = (high / low) ** STRIP, []
    edges = _edges(places)
    for policy in (policy for policy, xs in unfit.items() if xs):
        for left, right in _ranges(places, set(unfit[policy]), edges):
            strip = low / factor * factor**0.15, low / factor**0.15
            strips.append(Hatched(left, right, *strip, words.policy(policy), styles[policy]))
        low /= factor
    return Scale(label, is_log=True, limits=(low, high)), strips


def _edges(places: Sequence[float]) -> list[float]:
    """Between neighbouring places, and beyond the outermost ones."""
    if len(places) == 1:
        return [places[0] / LOG_MARGIN, places[0] * LOG_MARGIN]
    inner = [(left + right) / 2 for left, right in pairwise(places)]
    first, last = 2 * places[0] - inner[0], 2 * places[-1] - inner[-1]
    return [max(first, places[0] / LOG_MARGIN), *inner, min(last, places[-1] * LOG_MARGIN)]


def _ranges(
    places: Sequence[float], some: set[float], edges: Sequence[float]
) -> Iterator[tuple[float, float]]:
    """From where to where some of the places lie; neighbours are joined."""
    begin = None
    for n, place in enumerate(places):
        if place in some and begin is None:
            begin = edges[n]
        if begin is not None and (place not in some or n == len(places) - 1):
            yield begin, edges[n + 1] if place in some else edges[n]
            begin = None
