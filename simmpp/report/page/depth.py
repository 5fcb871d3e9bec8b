"""Every number of every point, for the browser to show the one that is chosen."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from simmpp.common.files import Row
from simmpp.methods.columns import FURTHER, NUMBERS
from simmpp.plot.curves import PART_COLOURS
from simmpp.plot.plotly_panels import N_COLOURS
from simmpp.report.page.figures.figure import styles_of
from simmpp.report.page.limits import PointLimits
from simmpp.report.page.measures import ALL
from simmpp.run import words
from simmpp.sweeps.profits import MEASURES, STATISTICS
from simmpp.sweeps.winners.points import ACCOUNTS, KEY_AXES, KINDS, Points

MOST_EXACT = 2**53
"""Larger integers are no numbers of JavaScript; they travel as texts."""
GAINS = (*(m + s for m in MEASURES for s in STATISTICS), "speedup", "efficiency", "n")


def depth_of(points: Points, limits: PointLimits) -> dict[str, Any]:
    """Columns of points, in their order, and of rows, each with the number of its point."""
    profits = points.profits
    titles = list(styles_of(profits))
    rows = [(number, row) for number, runs in enumerate(points.runs) for row in runs]
    # Of the paper's experiments some pack and have further columns, others do not.
    packed = [name for name in FURTHER if any(name in row for _, row in rows)]
    return {
        "places": [_place(points, numbers[0]) for numbers in points.places],
        "values": {
            words.SHORT.get(name, name): [
                words.value(name, profits[numbers[0]][name]) for numbers in points.places
            ]
            for name in points.axes
        },
        "keys": {
            name: _column((profits[numbers[0]] for numbers in points.places), name)
            for name in (*KEY_AXES, *points.further)
        },
        "titles": titles,
        "policies": [words.policy(title) for title in titles],
        "styles": [style % N_COLOURS for style in styles_of(profits).values()],
        "accounts": dict(ACCOUNTS),
        "kinds": dict(KINDS),
        "colours": PART_COLOURS,
        "points": {
            "place": points.groups,
            "name": [_name(points, row) for row in profits],
            "policy": [titles.index(row["policy"]) for row in profits],
            **{name: _column(profits, name) for name in GAINS},
        },
        "spreads": {name: _spreads(points, name) for name in MEASURES},
        "limits": [limits.told(number) for number in range(len(profits))],
        "rows": {
            "point": [number for number, _ in rows],
            **{
                name: _column((row for _, row in rows), name)
                for name in ("seed", *NUMBERS, *packed)
            },
        },
    }


def _spreads(points: Points, name: str) -> list[list[Any]]:
    """Mean and interval of a measure of each point, as curves show them."""
    spreads = (ALL[name].spread(points, number) for number in range(len(points.profits)))
    unknown = ([row[name], "", ""] for row in points.profits)  # such as infinite
    found = (of or rest for of, rest in zip(spreads, unknown, strict=True))
    return [[_exact(end) for end in of] for of in found]


def _place(points: Points, number: int) -> str:
    """What the policies of a place have in common; all there is, if it is the only one."""
    profit = points.profits[number]
    text = words.point(profit, points.axes or ("scene", "processors", "fraction"))
    held = words.value("fraction", points.at(number, "fraction"))
    more = held != words.value("fraction", profit["fraction"])  # they own more than was asked for
    return f"{text} (PEs hold {held})" if more else text


def _name(points: Points, row: Row) -> str:
    """All keys of a point: the same however many points there are."""
    return "|".join(str(row[name]) for name in (*KEY_AXES, *points.further, "policy"))


def _column(rows: Iterable[Row], name: str) -> list[Any]:
    return [_exact(row.get(name, "")) for row in rows]


def _exact(cell: Any) -> Any:
    """What JSON and JavaScript keep: digits of large integers, and infinity, as texts."""
    if isinstance(cell, int):
        return cell if abs(cell) < MOST_EXACT else str(cell)
    if isinstance(cell, float):
        return round(cell, 9) if words.is_finite(cell) else str(cell)
    return cell
