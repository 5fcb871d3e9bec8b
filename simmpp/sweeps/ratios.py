"""What rows say of a point: ratios of two policies or machines, seed by seed, and their means."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from statistics import fmean
from typing import NamedTuple

from simmpp.common.files import Row
from simmpp.policy.registry import CEILING, REFERENCE
from simmpp.run.profit import ratio

CONCURRENT, RAY, REPLICATED = "concurrent", "ray", CEILING
MAKESPAN, MESSAGES = "makespan_ps", "messages"


class Point(NamedTuple):
    """What a run is of, but for its seed."""

    scene: str
    processors: int
    fraction: float
    """x, from 0 to 1."""
    policy: str


Ratios = tuple[float, ...]
"""One for each seed, in their order."""


def mean(values: Sequence[float]) -> float:
    """The mean; nan, which is neither above nor below anything, if there is none."""
    return fmean(values) if values else math.nan


class Measured:
    """Rows of results by point; those with an error count as missing.

    ``numbers`` are what the caller knows points by; curves carry them.
    """

    def __init__(self, rows: Iterable[Row], numbers: Mapping[Point, int] | None = None) -> None:
        self.numbers = numbers or {}
        self._runs: dict[Point, dict[int, Row]] = {}
        for row in rows:
            point = Point(row["scene"], row["processors"], row["fraction"], row["policy"])
            of_point = self._runs.setdefault(point, {})
            if not row["error"]:
                of_point[row["seed"]] = row

    @property
    def scenes(self) -> list[str]:
        """Names of the scenes."""
        return sorted({point.scene for point in self._runs})

    @property
    def processors(self) -> list[int]:
        """Numbers of PEs."""
        return sorted({point.processors for point in self._runs})

    @property
    def fractions(self) -> list[float]:
        """X: the fractions x, rising."""
        return sorted({point.fraction for point in self._runs})

    @property
    def seeds(self) -> int:
        """Seeds of the point that has most."""
        return max(map(len, self._runs.values()), default=0)

    def ratios(self, column: str, above: Point, below: Point) -> Ratios:
        """The seed's own ratio of a column of ``results.csv`` between two points, for each seed.

        Nothing over nothing is 1, something over nothing is infinite.
        """
        upper, lower = self._runs.get(above, {}), self._runs.get(below, {})
        seeds = sorted(upper.keys() & lower.keys())
        return tuple(ratio(upper[seed][column], lower[seed][column]) for seed in seeds)

    def profit(self, column: str, scene: str, processors: int, x: float, policy: str) -> Ratios:
        """Object dataflow / policy: the time profit (of MAKESPAN) or the message profit."""
        point = Point(scene, processors, x, policy)
        return self.ratios(column, point._replace(policy=REFERENCE), point)

    def ray_over_object(self, scene: str, processors: int, x: float) -> Ratios:
        """T(ray) / T(object), as in the paper's figure 3."""
        point = Point(scene, processors, x, REFERENCE)
        return self.ratios(MAKESPAN, point._replace(policy=RAY), point)

    def acceleration(self, scene: str, x: float, few: int, many: int) -> Ratios:
        """T(few PEs) / T(many PEs) of concurrent dataflow, as in the paper's figure 6."""
        point = Point(scene, few, x, CONCURRENT)
        return self.ratios(MAKESPAN, point, point._replace(processors=many))

    def accounts(self, point: Point) -> dict[str, float]:
        """Shares of all PEs' time, over all seeds, that they compute, communicate and wait."""
        rows = self._runs.get(point, {}).values()
        names = ("compute", "communication", "waiting")
        sums = {name: sum(row[f"{name}_ps"] for row in rows) for name in names}
        total = sum(sums.values())
        return {name: value / total for name, value in sums.items() if total}
