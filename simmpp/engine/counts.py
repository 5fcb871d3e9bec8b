"""What a step-by-step run is made of: the paper's n(i, k) and r(i, j, k)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Counts:
    """Rays on each PE i at each of K steps, and which of them lack an object.

    r is kept sparse, as M entries other than 0, for it has K nb^2.
    """

    tests: NDArray[np.int64]
    """(K, nb) int64: n(i, k), rays that PE i tests at step k."""
    ended: NDArray[np.int64]
    """(K, nb) int64: rays deleted on PE i at step k."""
    steps: NDArray[np.int64]
    """(M,) int64: k of each entry of r."""
    holders: NDArray[np.int64]
    """(M,) int64: i, where the rays are when the step begins."""
    owners: NDArray[np.int64]
    """(M,) int64: j, who owns the objects that they lack."""
    rays: NDArray[np.int64]
    """(M,) int64: r(i, j, k), i != j."""

    def missing_by_holder(self) -> NDArray[np.int64]:
        """The sum of r(i, j, k) over j != i: (K, nb) int64."""
        return self._summed(self.holders)

    def missing_by_owner(self) -> NDArray[np.int64]:
        """The sum of r(j, i, k) over j != i: (K, nb) int64."""
        return self._summed(self.owners)

    def _summed(self, pes: NDArray[np.int64]) -> NDArray[np.int64]:
        total = np.zeros_like(self.tests)
        np.add.at(total, (self.steps, pes), self.rays)
        return total


class Counter:
    """Collects counts step by step."""

    def __init__(self, processors: int) -> None:
        self._processors = processors
        self._tests: list[NDArray[np.int64]] = []
        self._ended: list[NDArray[np.int64]] = []
        self._entries: list[NDArray[np.int64]] = []

    def add(self, tests: NDArray[np.int64], ended: NDArray[np.int64], r: NDArray[np.int64]) -> None:
        """Note one step; ``r`` is (nb, nb)."""
        holders, owners = np.nonzero(r)
        steps = np.full(len(holders), len(self._tests))
        self._entries.append(np.array([steps, holders, owners, r[holders, owners]], np.int64))
        self._tests.append(tests)
        self._ended.append(ended)

    def counts(self) -> Counts:
        """All steps so far."""
        entries = np.concatenate([np.zeros((4, 0), np.int64), *self._entries], axis=1)
        shape = (-1, self._processors)
        return Counts(
            np.array(self._tests, np.int64).reshape(shape),
            np.array(self._ended, np.int64).reshape(shape),
            *entries,
        )
