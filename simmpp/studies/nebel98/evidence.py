"""Values of claims by their (scene, nb, x) case: where they come from, and in what words."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from simmpp.studies.nebel98.verdict import Criterion
from simmpp.sweeps.ratios import CONCURRENT, CurvePoint, RowIndex, mean


class At(NamedTuple):
    """A (scene, nb, x) case."""

    scene: str
    processors: int
    x: float

    def __str__(self) -> str:
        return f"{self.scene}, {self.processors} PEs, x = {self.x:.4g}"


Values = dict[At, float]
"""A mean over seeds for each case."""


@dataclass(frozen=True)
class Evidence:
    """The rows of the figures that claims are about."""

    figure3: RowIndex
    figure4: RowIndex
    figure6: RowIndex


def points(measured: RowIndex) -> list[At]:
    """All cases, by scene, nb and x."""
    return [
        At(scene, processors, x)
        for scene in measured.scenes
        for processors in measured.processors
        for x in measured.fractions
    ]


def ray_over_object(measured: RowIndex) -> Values:
    """T(ray)/T(object)."""
    return {at: mean(measured.ray_over_object(*at)) for at in points(measured)}


def mean_profits(measured: RowIndex, column: str, policy: str = CONCURRENT) -> Values:
    """Object dataflow over a policy: the time profit (of MAKESPAN) or the message profit."""
    return {at: mean(measured.profit(column, *at, policy)) for at in points(measured)}


def criteria(
    values: Values,
    measured: RowIndex,
    policies: Sequence[str],
    low: float = -math.inf,
    high: float = math.inf,
    *,
    strict: bool = False,
) -> list[Criterion]:
    """A criterion for each value, which must lie from low to high, or strictly in between."""
    return [
        Criterion(str(at), value, low, high, strict, _accounts(measured, at, policies))
        for at, value in values.items()
    ]


def _accounts(measured: RowIndex, at: At, policies: Sequence[str]) -> dict[str, dict[str, float]]:
    return {policy: measured.accounts(CurvePoint(*at, policy)) for policy in policies}


def partitioned(values: Values) -> Values:
    """Where not all of the scene is on each PE."""
    return {at: value for at, value in values.items() if at.x < 1}


def of_scene(values: Values, scene: str) -> Values:
    """The values of one scene."""
    return {at: value for at, value in values.items() if at.scene == scene}


def largest(values: Iterable[float]) -> float:
    """The largest; nan if one is missing, or all are."""
    return float(np.max([*values] or [math.nan]))


def largest_at(values: Values) -> At:
    """Where the largest is; a missing one if there is one."""
    return list(values)[int(np.argmax([*values.values()]))]


def span(values: Iterable[float]) -> str:
    """From the least to the largest."""
    ordered = sorted(values)
    return f"{ordered[0]:.3g} to {ordered[-1]:.3g}" if ordered else "of no case"


def rank_correlation(a: Values, b: Values) -> float:
    """Spearman's, of two curves over the same X; nan if one is missing or constant."""
    from scipy.stats import rankdata  # takes half a second, and reports need no ranks

    curves = ([value for _, value in sorted(values.items())] for values in (a, b))
    ranks = [rankdata(curve, nan_policy="propagate") for curve in curves]
    with np.errstate(invalid="ignore"):
        return float(np.corrcoef(ranks[0], ranks[1])[0, 1])
