"""Profits, speed-up and efficiency of any sweep as curves with their intervals."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain

from simmpp.common.files import Row
from simmpp.plot.curves import LOG_MARGIN, Curve, Panel, Scale, Spread
from simmpp.report.page import scales
from simmpp.report.page.arrangement import Arrangement, Axes, abscissas, arrange, plates
from simmpp.report.page.figures.figure import Figure, slug, styles_of
from simmpp.run import words
from simmpp.sweeps.profits import MEASURES

MOST_ABSCISSAS, LEAST_VALUES, MOST_PLATES = 2, 3, 16
"""A measure is data along so many axes; the second has at least so many values, and at most so
many plates to choose from."""
HEADROOM = 1.06
"""Factor of room beyond the largest value."""
TITLES = {
    "time_profit": ("Time profit", "T(object dataflow) / T(policy)"),
    "message_profit": ("Message profit", "messages(object dataflow) / messages(policy)"),
    "speedup": ("Speed-up", "T(1 PE that holds everything) / T(policy)"),
    "efficiency": ("Efficiency", "speed-up / PEs"),
}
STEMS = tuple(measure.replace("_", "-") for measure in TITLES)
OF_MACHINE = ("speedup", "efficiency")


@dataclass(frozen=True)
class ProfitData:
    """The points that figures show, and those of another sweep that they are compared with."""

    profits: Sequence[Row]
    axes: Axes
    before: Sequence[Row] = ()
    marked: Mapping[str, frozenset[int]] = field(default_factory=dict)
    """Numbers of points to be looked at, by measure."""

    @property
    def rows(self) -> list[Row]:
        """All of them; numbers of points are those of ``profits``."""
        return [*self.profits, *self.before]


def profit_figures(data: ProfitData) -> Iterator[Figure]:
    """Both profits along the best axes; speed-up and efficiency along the number of PEs."""
    best, *others = abscissas(data.axes)
    long = [name for name in others if len(data.axes[name]) >= LEAST_VALUES]
    along = [best, *(name for name in long if _is_short(data, name))][:MOST_ABSCISSAS]
    for measure in MEASURES:
        title, _ = TITLES[measure]
        for name in along:
            several = len(along) > 1
            over = f"{title} over {words.ALONG.get(name, name)}" if several else title
            yield _figure(data, measure, name, over, f"-over-{slug(name)}" if several else "")
    if "processors" in data.axes:
        for measure in OF_MACHINE:
            name = "processors" if _is_short(data, "processors") else best
            yield _figure(data, measure, name, TITLES[measure][0])


def _is_short(data: ProfitData, along: str) -> bool:
    """Whether a figure along an axis has few plates."""
    rows = data.rows
    return len(plates(rows, arrange(rows, data.axes, along))) <= MOST_PLATES


def _figure(data: ProfitData, measure: str, along: str, title: str, suffix: str = "") -> Figure:
    rows = data.rows
    arrangement = arrange(rows, data.axes, along)
    panels_of = {
        plate: _panels(data, panels, measure, arrangement)
        for plate, panels in plates(rows, arrangement).items()
    }
    numeric = all(map(words.is_number, arrangement.values))
    spread = "" if data.before else f", {'bands' if numeric else 'bars'} are 95 % intervals"
    note = f"{TITLES[measure][1]}; {spread_note(rows, spread)}"
    return Figure(measure.replace("_", "-") + suffix, title, note, panels_of)


def spread_note(profits: Sequence[Row], spread: str) -> str:
    """In words, how many seeds a line is the mean of, and what its bands are."""
    least, most = (f(row["n"] for row in profits) for f in (min, max))
    if most < 2:
        return "one seed, so nothing is known of its spread"
    seeds = f"{most} seeds" if least == most else f"{least} to {most} seeds"
    return f"means of {seeds}{spread}"


def _panels(
    data: ProfitData,
    panels: Mapping[str, Sequence[tuple[int, Row]]],
    measure: str,
    arrangement: Arrangement,
) -> list[Panel]:
    x, places = scales.abscissa(arrangement.abscissa, list(arrangement.values))
    curves: dict[str, list[Curve]] = {}
    for title, numbered in panels.items():
        placed = [(number, places[row[arrangement.abscissa]], row) for number, row in numbered]
        curves[title] = list(_curves(data, placed, measure))
    y = _scale(TITLES[measure][0].lower(), chain(*curves.values()))
    level = 1.0 if measure in MEASURES else None
    return [Panel(title, x, y, of_panel, level=level) for title, of_panel in curves.items()]


def _scale(label: str, curves: Iterable[Curve]) -> Scale:
    """One scale for all panels of a plate; logarithmic if values differ much."""
    spreads = [spread for curve in curves for spread in curve.points.values()]
    if not spreads:
        return Scale(label)
    low, high = min(spread.low for spread in spreads), max(spread.high for spread in spreads)
    if low > 0 and scales.is_log(spread.mean for spread in spreads):
        return Scale(label, is_log=True, limits=(low / LOG_MARGIN, high * LOG_MARGIN))
    return Scale(label, limits=(min(low, 0.0), (high or 1.0) * HEADROOM))


Placed = tuple[int, float, Row]
"""A point: its number, where it lies on the abscissa, its row."""


def _curves(data: ProfitData, placed: Sequence[Placed], measure: str) -> Iterator[Curve]:
    """One curve for each policy, in the order of their colours; what was before lies behind."""
    last = len(data.profits)
    finite = [point for point in placed if words.is_finite(point[2][measure])]
    for is_before in (True, False):
        for title, style in styles_of(data.rows).items():
            of = [p for p in finite if p[2]["policy"] == title and (p[0] >= last) == is_before]
            if of:
                points = {x: _spread(row, measure) for _, x, row in of}
                numbers = {} if is_before else {x: number for number, x, _ in of}
                marked = data.marked.get(measure, frozenset())
                yield Curve(
                    words.policy(title),
                    points,
                    style=style,
                    rows=numbers,
                    is_before=is_before,
                    marked=frozenset(x for x, number in numbers.items() if number in marked),
                )


def _spread(row: Row, measure: str) -> Spread:
    """The mean and its interval; where there is none, as for one seed, no more than the mean."""
    mean = row[measure]
    ends = [row.get(measure + end, "") for end in ("_low", "_high")]
    low, high = (end if words.is_number(end) else mean for end in ends)
    return Spread(mean, low, high)
