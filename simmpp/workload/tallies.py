"""What rays leave in objects: sums, sums of squares and counts, in whole numbers of 2^-32.

Each test leaves what ``test_deposits`` says; where a workload says nothing a ray leaves the weight
of its root in the object that it hits, once. Whole numbers are added, so it does not matter in
which order, nor who adds: tallies made of the tests of simulated PEs are those of the tracer, bit
for bit.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import WorkloadError
from simmpp.workload.check import MOST_DEPOSITED
from simmpp.workload.workload import Workload

UNITS = 2.0**32
Ints = NDArray[np.int32]
Longs = NDArray[np.int64]


class Tally(NamedTuple):
    """Of each object; whole numbers, sums in units of 2^-32."""

    sums: Longs
    """(N,) int64: what was deposited."""
    squares: Longs
    """(N,) int64: the squares of the deposits, each rounded down to a unit."""
    counts: Longs
    """(N,) int64: deposits that are not 0."""


def tally_of(workload: Workload) -> Tally:
    """The tally of all tests that a workload records.

    Raises WorkloadError if what is deposited is too much to be counted.
    """
    if len(workload.test_deposits):
        return _tally(workload, workload.itinerary_objects, workload.test_deposits)
    return _tally_of_hits(workload, np.flatnonzero(workload.hits >= 0))


def tally_of_tests(workload: Workload, tested_rays: Ints, tested_objects: Ints) -> Tally:
    """The same of tests that were made, those of a ray in the order in which it makes them.

    Tests that are not of the workload deposit nothing.
    """
    if len(workload.test_deposits) == 0:
        hitting = tested_objects == workload.hits[tested_rays]
        return _tally_of_hits(workload, np.unique(tested_rays[hitting]))
    order = np.argsort(tested_rays, kind="stable")
    rays, objects = tested_rays[order], tested_objects[order]
    of_ray = np.bincount(rays, minlength=workload.n_rays)
    rank = np.arange(len(rays)) - (np.cumsum(of_ray) - of_ray)[rays]
    at = workload.itinerary_offsets[rays] + rank
    known = at < workload.itinerary_offsets[rays + 1]
    known[known] = workload.itinerary_objects[at[known]] == objects[known]
    return _tally(workload, objects[known], workload.test_deposits[at[known]])


def leaving(workload: Workload) -> NDArray[np.uint8]:
    """Which tests leave a deposit in an object that has results: (tests,) uint8, 1 or 0."""
    objects, offsets = workload.itinerary_objects, workload.itinerary_offsets
    if len(workload.object_results) == 0:
        return np.zeros(len(objects), np.uint8)
    counts = workload.object_results[objects] > 0
    if len(workload.test_deposits):
        return (counts & (workload.test_deposits > 0)).astype(np.uint8)
    rays = np.repeat(np.arange(workload.n_rays), np.diff(offsets))
    hitting = np.flatnonzero(objects == workload.hits[rays])
    last = np.zeros(workload.n_rays, np.int64)
    last[rays[hitting]] = hitting  # of several tests of what it hits, the last one
    leaves = np.zeros(len(objects), np.uint8)
    leaves[last[rays[hitting]]] = 1
    if len(workload.root_weights):
        leaves[workload.root_weights[workload.pixels[rays]] == 0] = 0
    return np.asarray(leaves * counts, np.uint8)


def table_of(tally: Tally) -> dict[str, NDArray[np.generic]]:
    """A row for each object; the sums as numbers."""
    return {
        "object": np.arange(len(tally.sums), dtype=np.int32),
        "sum": tally.sums / UNITS,
        "sum_of_squares": tally.squares / UNITS,
        "count": tally.counts,
    }


def _tally_of_hits(workload: Workload, rays: NDArray[np.signedinteger]) -> Tally:
    weights = workload.root_weights if len(workload.root_weights) else np.ones(1)
    if weights.max(initial=0) * UNITS * max(workload.n_rays, 1) >= MOST_DEPOSITED:
        problem = f"the weights are too great for results: expected at most {2.0**20:g}"
        raise WorkloadError(problem, where=workload.name)
    units = np.rint(weights * UNITS).astype(np.int64)
    roots = workload.pixels[rays] if len(weights) > 1 else np.zeros(len(rays), np.int64)
    return _tally(workload, workload.hits[rays], units[roots])


def _tally(workload: Workload, objects: Ints, deposits: Longs) -> Tally:
    squares = _squares(deposits)
    if squares.sum(dtype=np.float64) >= MOST_DEPOSITED:
        raise WorkloadError("the squares of deposits are too great", where=workload.name)
    tally = Tally(*(np.zeros(workload.n_objects, np.int64) for _ in Tally._fields))
    np.add.at(tally.sums, objects, deposits)
    np.add.at(tally.squares, objects, squares)
    np.add.at(tally.counts, objects, (deposits > 0).astype(np.int64))
    return tally


def _squares(deposits: Longs) -> Longs:
    """In units, rounded down; in two halves, as the square itself has 128 bits."""
    wholes, rest = deposits >> 32, (deposits & 0xFFFFFFFF).astype(np.uint64)
    small = (rest * rest >> np.uint64(32)).astype(np.int64)
    return (wholes * wholes << 32) + 2 * wholes * rest.astype(np.int64) + small
