"""Profits, speed-up and efficiency of any sweep as curves with their intervals."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain

from simmpp.report.curves import Curve, Panel, Scale, Spread
from simmpp.report.page import words
from simmpp.report.page.arrangement import Arrangement, Axes, abscissas, arrange, plates
from simmpp.report.page.figure import Figure, slug, styles_of
from simmpp.sweeps.tables import Row

MOST_ABSCISSAS, ENOUGH = 2, 3
"""A measure is shown along so many axes; the second has at least so many values."""
MARGIN, LOG_MARGIN = 1.06, 1.2
"""Room beyond the largest value, and beyond both ends of a logarithmic axis."""
TITLES = {
    "time_profit": ("Time profit", "T(object dataflow) / T(policy)"),
    "message_profit": ("Message profit", "messages(object dataflow) / messages(policy)"),
    "speedup": ("Speed-up", "T(1 PE that holds everything) / T(policy)"),
    "efficiency": ("Efficiency", "speed-up / PEs"),
}
PROFITS, OF_MACHINE = ("time_profit", "message_profit"), ("speedup", "efficiency")


def profit_figures(profits: Sequence[Row], axes: Axes) -> Iterator[Figure]:
    """Both profits along the best axes; speed-up and efficiency along the number of PEs."""
    best, *others = abscissas(axes)
    along = [best, *(name for name in others if len(axes[name]) >= ENOUGH)][:MOST_ABSCISSAS]
    for measure in PROFITS:
        for name in along:
            yield _figure(profits, axes, measure, name, len(along) > 1)
    if "processors" in axes:
        for measure in OF_MACHINE:
            yield _figure(profits, axes, measure, "processors", False)


def _figure(
    profits: Sequence[Row], axes: Axes, measure: str, along: str, is_one_of_several: bool
) -> Figure:
    arrangement = arrange(profits, axes, along)
    title, formula = TITLES[measure]
    stem = measure.replace("_", "-")
    if is_one_of_several:
        title, stem = f"{title} over {words.ALONG.get(along, along)}", f"{stem}-over-{slug(along)}"
    styles = styles_of(profits)
    found = {
        plate: _panels(panels, measure, arrangement, styles)
        for plate, panels in plates(profits, arrangement).items()
    }
    return Figure(stem, title, f"{formula}; {spread_note(profits)}", found)


def spread_note(profits: Sequence[Row]) -> str:
    """What lines and bands are."""
    least, most = (f(row["n"] for row in profits) for f in (min, max))
    if most < 2:
        return "one seed, so nothing is known of its spread"
    seeds = f"{most} seeds" if least == most else f"{least} to {most} seeds"
    return f"means of {seeds}, bands are 95 % intervals"


def _panels(
    panels: dict[str, list[tuple[int, Row]]],
    measure: str,
    arrangement: Arrangement,
    styles: dict[str, int],
) -> list[Panel]:
    x, places = words.abscissa(arrangement.abscissa, list(arrangement.values))
    curves = {
        title: list(_curves(rows, measure, arrangement, places, styles))
        for title, rows in panels.items()
    }
    y = _scale(TITLES[measure][0].lower(), chain(*curves.values()))
    level = 1.0 if measure in PROFITS else None
    return [Panel(title, x, y, found, level=level) for title, found in curves.items()]


def _scale(label: str, curves: Iterable[Curve]) -> Scale:
    """One scale for all panels of a plate; logarithmic if values differ much."""
    spreads = [spread for curve in curves for spread in curve.points.values()]
    if not spreads:
        return Scale(label)
    low, high = min(each.low for each in spreads), max(each.high for each in spreads)
    if low > 0 and words.is_log(each.mean for each in spreads):
        return Scale(label, is_log=True, limits=(low / LOG_MARGIN, high * LOG_MARGIN))
    return Scale(label, limits=(min(low, 0.0), high * MARGIN))


def _curves(
    rows: Sequence[tuple[int, Row]],
    measure: str,
    arrangement: Arrangement,
    places: dict[object, float],
    styles: dict[str, int],
) -> Iterator[Curve]:
    """One curve for each policy, in the order of their colours."""
    for title, style in styles.items():
        of_policy = {
            places[row[arrangement.abscissa]]: (number, row)
            for number, row in rows
            if row["policy"] == title and words.is_finite(row[measure])
        }
        if of_policy:
            points = {x: _spread(row, measure) for x, (_, row) in of_policy.items()}
            numbers = {x: number for x, (number, _) in of_policy.items()}
            yield Curve(words.policy(title), points, style=style, rows=numbers)


def _spread(row: Row, measure: str) -> Spread:
    """The mean and its interval; where there is none, as for one seed, no more than the mean."""
    mean = row[measure]
    ends = [row.get(measure + end, "") for end in ("_low", "_high")]
    low, high = (end if words.is_number(end) else mean for end in ends)
    return Spread(mean, low, high)
