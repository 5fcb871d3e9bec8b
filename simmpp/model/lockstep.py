"""When each ray would be traced if all rays made one test per step: the paper's stages k.

All primary rays start at step 0. A ray makes the tests of its itinerary in successive steps and is
deleted in its last one; its children are generated there and begin in the next step. Steps depend
on neither machine nor policy, so the number of rays at each step, with the start and the decay, is
known before anything is simulated.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import njit
from simmpp.workload.workload import Workload


@dataclass(frozen=True, eq=False)
class Steps:
    """Rays of the whole machine at each of K steps."""

    tests: NDArray[np.int64]
    """(K,) int64: tests made, which is the number of rays that need an object."""
    ended: NDArray[np.int64]
    """(K,) int64: rays deleted."""


def first_steps(workload: Workload) -> NDArray[np.int64]:
    """The step at which each ray begins: (n,) int64."""
    return _first_steps(workload.parents, workload.itinerary_offsets)


def steps_of(workload: Workload) -> Steps:
    """How many rays are there at each step."""
    begins = first_steps(workload)
    lengths = np.diff(workload.itinerary_offsets)
    lasts = begins + np.maximum(lengths, 1) - 1
    n_steps = int(lasts.max()) + 1 if len(lasts) else 0
    tested = lengths > 0
    come = np.bincount(begins[tested], minlength=n_steps + 1)
    gone = np.bincount(lasts[tested] + 1, minlength=n_steps + 1)
    return Steps(np.cumsum(come - gone)[:n_steps], np.bincount(lasts, minlength=n_steps))


@njit
def _first_steps(
    parents: NDArray[np.int32], itinerary_offsets: NDArray[np.int64]
) -> NDArray[np.int64]:
    begins = np.zeros(parents.size, np.int64)
    for ray in range(parents.size):
        parent = parents[ray]
        if parent >= 0:
            length = itinerary_offsets[parent + 1] - itinerary_offsets[parent]
            begins[ray] = begins[parent] + max(length, 1)
    return begins
