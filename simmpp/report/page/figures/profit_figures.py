"""Makespan, profits, memory and cost of any sweep as curves with their intervals."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain

from simmpp.common.files import Row
from simmpp.plot.curves import LOG_MARGIN, PERCENT, Curve, Panel, Scale, Spread
from simmpp.report.page import scales
from simmpp.report.page.arrangement import Arrangement, Axes, abscissas, arrange, plates
from simmpp.report.page.figures.figure import Figure, slug, styles_of
from simmpp.report.page.measures import ALL, unit_of
from simmpp.run import words
from simmpp.sweeps.winners.points import Points, varying_axes

MOST_ABSCISSAS, LEAST_VALUES, MOST_PLATES = 2, 3, 16
"""A measure is data along so many axes; the second has at least so many values, and at most so
many plates to choose from."""
HEADROOM = 1.06
"""Factor of room beyond the largest value."""
POLICY = "policy"
STEMS = tuple(name.replace("_", "-") for name in ALL)


@dataclass(frozen=True)
class ProfitData:
    """The points that figures show, and those of another sweep that they are compared with."""

    points: Points
    before: Points | None = None
    marked: Mapping[str, frozenset[int]] = field(default_factory=dict)
    """Numbers of points to be looked at, by measure."""
    lines: str = POLICY
    """The column whose values are lines; if that is an axis, policies are one in its place."""

    @cached_property
    def rows(self) -> list[Row]:
        """Profits of all of them; numbers of points are those of ``points``."""
        return [*self.points.profits, *(self.before.profits if self.before else ())]

    @cached_property
    def axes(self) -> Axes:
        """The axes along which they differ, but for what lines are."""
        axes = varying_axes(self.rows, (*self.points.further, POLICY))
        return {name: values for name, values in axes.items() if name != self.lines}

    def called(self, title: str) -> str:
        """What a line is called."""
        return words.policy(title) if self.lines == POLICY else title

    def found(self, number: int) -> tuple[Points, int]:
        """Which points a number is of, and its number there."""
        last = len(self.points.profits)
        if self.before is None or number < last:
            return self.points, number
        return self.before, number - last


def profit_figures(data: ProfitData) -> Iterator[Figure]:
    """Measures along the best axes; those of the machine along the number of PEs."""
    best, *others = abscissas(data.axes)
    long = [name for name in others if len(data.axes[name]) >= LEAST_VALUES]
    along = [best, *(name for name in long if _is_short(data, name))][:MOST_ABSCISSAS]
    for name, measure in ALL.items():
        if not measure.needs_processors:
            axes = along if measure.second else along[:1]
            yield from _along(data, name, axes)
        elif "processors" in data.axes:
            axis = "processors" if _is_short(data, "processors") else best
            yield from _along(data, name, [axis])


def _is_short(data: ProfitData, along: str) -> bool:
    """Whether a figure along an axis has few plates."""
    return len(plates(data.rows, arrange(data.rows, data.axes, along))) <= MOST_PLATES


def _along(data: ProfitData, name: str, axes: Sequence[str]) -> Iterator[Figure]:
    """A measure's figures, of which only the first is looked at unasked; none without values."""
    measure = ALL[name]
    found = {number: measure.spread(*data.found(number)) for number in range(len(data.rows))}
    spreads = {number: spread for number, spread in found.items() if spread is not None}
    for axis in axes if spreads else ():
        several = len(axes) > 1
        title = f"{measure.title} over {words.ALONG.get(axis, axis)}" if several else measure.title
        stem = name.replace("_", "-") + (f"-over-{slug(axis)}" if several else "")
        arrangement = arrange(data.rows, data.axes, axis)
        panels_of = {
            plate: _panels(data, panels, name, arrangement, spreads)
            for plate, panels in plates(data.rows, arrangement).items()
        }
        note = f"{measure.meaning}; {spread_note(data, arrangement)}"
        yield Figure(stem, title, note, panels_of, measure.is_folded or axis != axes[0])


def spread_note(data: ProfitData, arrangement: Arrangement) -> str:
    """In words, how many seeds a line is the mean of, what its bands are, and where points lie."""
    own = _own_objects(data)
    numbers = [len(runs) for runs in data.points.runs if runs]
    least, most = min(numbers, default=0), max(numbers, default=0)
    if most == 1:
        return f"one seed, so nothing is known of its spread{own}"
    seeds = f"{most} seeds" if least == most else f"{least} to {most} seeds"
    means = f"geometric means of {seeds}" if most else "means of seeds"
    if data.before is not None:
        return means + own
    form = "bands" if all(map(words.is_number, arrangement.values)) else "bars"
    return f"{means}, {form} are 95 % intervals (Student's t of the logarithms){own}"


def _own_objects(data: ProfitData) -> str:
    """What must be said of x where it is less than PEs own."""
    points, rows = data.points, data.points.profits
    less = [n for n, row in enumerate(rows) if row["fraction"] != "" and _is_less(row)]
    notes = []
    if any(points.held(n) != rows[n]["fraction"] for n in less):
        notes.append("where PEs own more than x, points lie at what they hold")
    if any(points.held(n) == rows[n]["fraction"] for n in less):
        notes.append(
            "PEs hold at least what they own: below that, x is only room for fetched objects"
        )
    return "".join(f"; {note}" for note in notes)


def _is_less(row: Row) -> bool:
    """Asked for fewer objects than PEs own."""
    return bool(row["fraction"] * row["processors"] < 1)


def _panels(
    data: ProfitData,
    panels: Mapping[str, Sequence[tuple[int, Row]]],
    name: str,
    arrangement: Arrangement,
    spreads: Mapping[int, Spread],
) -> list[Panel]:
    measure, along = ALL[name], arrangement.abscissa
    x, places = scales.abscissa(along, list(arrangement.values))
    numbers = {title: [n for n, _ in of if n in spreads] for title, of in panels.items()}
    unit, size = unit_of(measure, (spreads[n].mean for n in chain(*numbers.values())))
    curves: dict[str, list[Curve]] = {}
    for title, of in numbers.items():
        placed = {n: _place(data, n, along, places[data.rows[n][along]]) for n in of}
        units = {n: Spread(*(end / size for end in spreads[n])) for n in of}
        curves[title] = list(_curves(data, placed, units, name))
    label = words.uncapital(measure.title) + (f" ({unit})" if unit else "")
    y = scale_of(label, chain(*curves.values()))
    return [Panel(title, x, y, of, level=measure.level) for title, of in curves.items()]


def _place(data: ProfitData, number: int, along: str, asked: float) -> float:
    """Where a point lies: along x by what its PEs really hold."""
    if along != "fraction" or not all(map(words.is_number, data.axes[along])):
        return asked
    points, own_number = data.found(number)
    return float(points.held(own_number)) * PERCENT


def scale_of(label: str, curves: Iterable[Curve]) -> Scale:
    """One scale for all panels of a plate; logarithmic if values differ much."""
    spreads = [spread for curve in curves for spread in curve.points.values()]
    if not spreads:
        return Scale(label)
    low, high = min(spread.low for spread in spreads), max(spread.high for spread in spreads)
    if scales.is_log(spread.mean for spread in spreads):
        return Scale(label, is_log=True, limits=(low / LOG_MARGIN, high * LOG_MARGIN))
    return Scale(label, limits=(0.0, (high or 1.0) * HEADROOM))


def _curves(
    data: ProfitData, placed: Mapping[int, float], spreads: Mapping[int, Spread], name: str
) -> Iterator[Curve]:
    """One curve for each policy, in the order of their colours; what was before lies behind.

    Points that are one, as PEs hold the same wherever x was asked to be, are drawn once.
    """
    last, marked = len(data.points.profits), data.marked.get(name, frozenset())
    for is_before in (True, False):
        for title, style in styles_of(data.rows, data.lines).items():
            rows, lines = data.rows, data.lines
            of = [n for n in placed if rows[n][lines] == title and (n >= last) == is_before]
            numbers: dict[float, int] = {}
            for number in of:
                numbers.setdefault(placed[number], number)
            if numbers:
                yield Curve(
                    data.called(title),
                    {x: spreads[n] for x, n in numbers.items()},
                    style=style,
                    rows={} if is_before else numbers,
                    is_before=is_before,
                    marked=frozenset(placed[n] for n in of if n in marked),
                )
