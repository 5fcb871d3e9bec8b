"""What rows say of a point: ratios of two policies or machines, seed by seed, and their means."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import chain
from statistics import fmean
from typing import Any, NamedTuple

from simmpp.common.files import Row
from simmpp.methods.columns import PLACE
from simmpp.policy.parameters import CEILING, REFERENCE
from simmpp.run.profit import ratio
from simmpp.run.rows import Seeds, by_place, finished, pairs

CONCURRENT, RAY, REPLICATED = "concurrent", "ray", CEILING
MAKESPAN, MESSAGES = "makespan_ps", "messages"


class CurvePoint(NamedTuple):
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


class RowIndex:
    """Rows of results by point; those with an error count as missing.

    ``numbers`` are what the caller knows points by; curves carry them.
    """

    def __init__(
        self, rows: Iterable[Row], numbers: Mapping[CurvePoint, int] | None = None
    ) -> None:
        self.numbers = numbers or {}
        self._places = by_place(rows, PLACE)
        axes: list[list[Any]] = [
            sorted({place[axis] for place in self._places}) for axis in range(len(PLACE))
        ]
        self.scenes: list[str] = axes[0]
        """Names of the scenes."""
        self.processors: list[int] = axes[1]
        """Numbers of PEs."""
        self.fractions: list[float] = axes[2]
        """X: the fractions x, rising."""

    @property
    def seeds(self) -> int:
        """Seeds of the point that has most."""
        points = chain(*(policies.values() for policies in self._places.values()))
        return max((len(finished(seeds)) for seeds in points), default=0)

    def _of(self, point: CurvePoint) -> Seeds:
        *place, policy = point
        return self._places.get(tuple(place), {}).get(policy, {})

    def ratios(self, column: str, above: CurvePoint, below: CurvePoint) -> Ratios:
        """The seed's own ratio of a column of ``results.csv`` between two points, for each seed.

        Nothing over nothing is 1, something over nothing is infinite.
        """
        both = pairs(self._of(above), self._of(below))
        return tuple(ratio(upper[column], lower[column]) for upper, lower in both)

    def profit(self, column: str, scene: str, processors: int, x: float, policy: str) -> Ratios:
        """Object dataflow / policy: the time profit (of MAKESPAN) or the message profit."""
        point = CurvePoint(scene, processors, x, policy)
        return self.ratios(column, point._replace(policy=REFERENCE), point)

    def ray_over_object(self, scene: str, processors: int, x: float) -> Ratios:
        """T(ray) / T(object), as in the paper's figure 3."""
        point = CurvePoint(scene, processors, x, REFERENCE)
        return self.ratios(MAKESPAN, point._replace(policy=RAY), point)

    def acceleration(self, scene: str, x: float, few: int, many: int) -> Ratios:
        """T(few PEs) / T(many PEs) of concurrent dataflow, as in the paper's figure 6."""
        point = CurvePoint(scene, few, x, CONCURRENT)
        return self.ratios(MAKESPAN, point, point._replace(processors=many))

    def accounts(self, point: CurvePoint) -> dict[str, float]:
        """Shares of all PEs' time, over all seeds, that they compute, communicate and wait."""
        rows = finished(self._of(point)).values()
        names = ("compute", "communication", "waiting")
        sums = {name: sum(row[f"{name}_ps"] for row in rows) for name in names}
        total = sum(sums.values())
        return {name: value / total for name, value in sums.items() if total}
