"""Which policies fit where, as a table."""

from __future__ import annotations

from simmpp.common.files import Row, sort_key
from simmpp.run import words
from simmpp.sweeps.winners.fitting import fit_of
from simmpp.sweeps.winners.points import Points


def fit_table(points: Points) -> list[Row]:
    """A line for each case, a column for each policy; nothing where memory has no end."""
    flows = dict.fromkeys(points.flow(n) for n in range(len(points.profits)))
    lines = []
    for place in sorted(
        points.cases, key=lambda of: sort_key(points.profits[of[0]], list(points.axes))
    ):
        found = {points.flow(n): fit_of(points, n) for n in place}
        if any(found.values()):
            keys = {
                words.SHORT.get(n, n): words.value(n, points.at(place[0], n)) for n in points.axes
            }
            cells = {flow: str(found.get(flow) or "") for flow in flows}
            lines.append({**keys, **cells})
    return lines
