"""Values of claims by their (scene, nb, x) case: where they come from, and in what words."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.studies.nebel98.verdict import Case
from simmpp.sweeps.ratios import CONCURRENT, Measured, Point, mean


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

    figure3: Measured
    figure4: Measured
    figure6: Measured


def points(measured: Measured) -> list[At]:
    """All cases, by scene, nb and x."""
    return [
        At(scene, processors, x)
        for scene in measured.scenes
        for processors in measured.processors
        for x in measured.fractions
    ]


def ray_over_object(measured: Measured) -> Values:
    """T(ray)/T(object)."""
    return {at: mean(measured.ray_over_object(*at)) for at in points(measured)}


def profits(measured: Measured, column: str, policy: str = CONCURRENT) -> Values:
    """Object dataflow over a policy: the time profit (of MAKESPAN) or the message profit."""
    return {at: mean(measured.profit(column, *at, policy)) for at in points(measured)}


def cases(
    values: Values,
    measured: Measured,
    policies: Sequence[str],
    low: float = -math.inf,
    high: float = math.inf,
    *,
    above: float | None = None,
) -> list[Case]:
    """A case for each value, which must lie from low to high, or strictly above."""
    strict = above is not None
    low = low if above is None else above
    return [
        Case(str(at), value, low, high, strict, _accounts(measured, at, policies))
        for at, value in values.items()
    ]


def _accounts(measured: Measured, at: At, policies: Sequence[str]) -> dict[str, dict[str, float]]:
    return {policy: measured.accounts(Point(*at, policy)) for policy in policies}


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
    found = sorted(values)
    return f"{found[0]:.3g} to {found[-1]:.3g}" if found else "of no case"


def rank_correlation(a: Values, b: Values) -> float:
    """Spearman's, of two curves over the same X; nan if one is missing or constant."""
    ranks = [_ranks([value for _, value in sorted(each.items())]) for each in (a, b)]
    with np.errstate(invalid="ignore"):
        return float(np.corrcoef(ranks[0], ranks[1])[0, 1])


def _ranks(values: list[float]) -> NDArray[np.float64]:
    """The rank of each value, equal ones sharing theirs; nan if one is missing."""
    _, which, counts = np.unique(values, return_inverse=True, return_counts=True)
    ranks = np.cumsum(counts) - (counts - 1) / 2
    return np.where(np.isnan(values).any(), np.nan, ranks[which])
