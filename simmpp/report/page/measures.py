"""What curves show of a point: its measures, seed by seed, and how well their means are known.

All are positive and differ by factors, so means and intervals are those of logarithms: an interval
never reaches below 0, and a profit of 1/2 is as far from 1 as one of 2. ``profits.csv`` has plain
means and intervals of the same ratios.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from simmpp.common.units import SIZES, TIMES
from simmpp.plot.curves import Spread
from simmpp.report.page import scales
from simmpp.run import words
from simmpp.run.profit import efficiency, speedup
from simmpp.run.rows import pairs
from simmpp.sweeps.intervals import of_logarithms
from simmpp.sweeps.profits import MEASURES, profits_of
from simmpp.sweeps.winners.points import Points


@dataclass(frozen=True)
class Measure:
    """Something that each seed of a point has a value of."""

    title: str
    meaning: str
    values: Callable[[Points, int], list[float]]
    """Of a point, by its number: one for each seed that has one."""
    units: tuple[tuple[str, int], ...] = ()
    level: float | None = None
    """What divides better from worse."""
    column: str = ""
    """Of ``profits.csv``, where that has its mean."""
    needs_processors: bool = False
    """Says little unless the number of PEs varies."""
    second: bool = True
    """Is also shown along the second axis."""
    is_folded: bool = False
    """Shown at first only if it is asked for."""

    def spread(self, points: Points, number: int) -> Spread | None:
        """Its mean and interval; without one no more than the mean, without a value nothing."""
        row = points.profits[number]
        if not points.runs[number]:
            mean = row.get(self.column, "")
            return Spread(mean, mean, mean) if words.is_finite(mean) else None
        values = self.values(points, number)
        mean, low, high = of_logarithms(values, points.confidence)
        if low == high:  # equal by luck, perhaps: who chose the seeds wrote how much they may err
            low, high = (row.get(self.column + end, "") for end in ("_low", "_high"))
        known = words.is_finite(low) and words.is_finite(high)
        if not words.is_finite(mean):
            return None
        return Spread(mean, low, high) if known else Spread(mean, mean, mean)


def _profit(column: str) -> Callable[[Points, int], list[float]]:
    return lambda points, n: profits_of(pairs(points.references(n), points.seeds[n]), column)


def _column(column: str) -> Callable[[Points, int], list[float]]:
    return lambda points, n: [row[column] for row in points.runs[n] if row[column] != ""]


def _speedups(points: Points, number: int) -> list[float]:
    return [speedup(row) for row in points.runs[number] if row["compute_ps"] != ""]


def _efficiencies(points: Points, number: int) -> list[float]:
    return [efficiency(row) for row in points.runs[number] if row["compute_ps"] != ""]


def _node_times(points: Points, number: int) -> list[float]:
    nb = points.profits[number]["processors"]
    return [nb * row["makespan_ps"] for row in points.runs[number]]


ALL = {
    "makespan": Measure(
        "Makespan",
        "simulated time until the last ray is finished: less is better",
        _column("makespan_ps"),
        TIMES,
    ),
    "time_profit": Measure(
        "Time profit",
        "T(object dataflow) / T(policy): more is better, 1 is object dataflow",
        _profit(MEASURES["time_profit"]),
        level=1.0,
        column="time_profit",
    ),
    "speedup": Measure(
        "Speed-up",
        "T(1 PE that holds everything) / T(policy): more is better",
        _speedups,
        column="speedup",
        needs_processors=True,
    ),
    "peak_bytes": Measure(
        "Bytes per PE",
        "most bytes (objects and rays) that any one PE ever held: less is better",
        _column("peak_bytes"),
        SIZES,
        second=False,
    ),
    "message_profit": Measure(
        "Message profit",
        "messages(object dataflow) / messages(policy): more is better",
        _profit(MEASURES["message_profit"]),
        level=1.0,
        column="message_profit",
        is_folded=True,
    ),
    "efficiency": Measure(
        "Efficiency",
        "speed-up / PEs: the share of all PEs' time that is worth its while",
        _efficiencies,
        column="efficiency",
        needs_processors=True,
        is_folded=True,
    ),
    "node_seconds": Measure(
        "Node-seconds",
        "PEs x makespan: what a run costs where nodes are paid by the second; less is better",
        _node_times,
        TIMES,
        needs_processors=True,
        is_folded=True,
    ),
}
"""In the order of the page."""


def unit_of(measure: Measure, values: Iterable[float]) -> tuple[str, int]:
    """The unit in which typical values have few digits; none, and 1, for ratios."""
    return scales.unit_of(measure.units, values)
