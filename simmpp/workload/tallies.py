"""What rays leave in objects: sums, sums of squares and counts, in whole numbers of 2^-32.

Each test leaves what ``test_deposits`` says; where a workload says nothing a ray leaves the weight
of its root in the object that it hits, once. Whole numbers are added, so it does not matter in
which order, nor who adds: tallies made of the tests of simulated PEs are those of the tracer, bit
for bit.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.workload.workload import Workload

UNITS, BITS, MASK = 2.0**32, np.uint64(32), np.uint64(0xFFFFFFFF)
MOST_BITS = 30
"""Of the weights of all rays together, so that int64 holds their sum in units."""
Ints = NDArray[np.int32]
Longs = NDArray[np.int64]


class Tally(NamedTuple):
    """Of each object, in whole numbers that stand for 2^-32, or for 2^``scale`` times as much."""

    sums: Longs
    """(N,) int64: what was deposited."""
    squares: Longs
    """(N,) int64: the squares of the deposits without their units, so of 2^32 of them squared,"""
    rests: Longs
    """(N,) int64: and those units, each square rounded down to one."""
    counts: Longs
    """(N,) int64: deposits that are not 0."""
    scale: int = 0
    """Above 0 where all weights together are 2^30 and more."""


def tally_of(workload: Workload) -> Tally:
    """The tally of all tests that a workload records."""
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
        "sum": tally.sums / UNITS * 2.0**tally.scale,
        "sum_of_squares": (tally.squares + tally.rests / UNITS) * 4.0**tally.scale,
        "count": tally.counts,
    }


def _tally_of_hits(workload: Workload, rays: NDArray[np.signedinteger]) -> Tally:
    """Of rays that leave the weight of their root in what they hit."""
    weights, roots = workload.root_weights, workload.pixels[rays]
    if len(weights) == 0:
        return _tally(workload, workload.hits[rays], np.full(len(rays), 1 << 32, np.int64))
    # Of all rays, so that a part of them has the same units.
    total = float(weights.max(initial=0)) * workload.n_rays
    scale = max(0, math.frexp(total)[1] - MOST_BITS)
    units = np.rint(weights * (UNITS / 2.0**scale)).astype(np.int64)
    return _tally(workload, workload.hits[rays], units[roots])._replace(scale=scale)


def _tally(workload: Workload, objects: Ints, deposits: Longs) -> Tally:
    squares, rests = _squares(deposits)
    counts = (deposits > 0).astype(np.int64)
    totals = np.zeros((4, workload.n_objects), np.int64)
    for total, each in zip(totals, (deposits, squares, rests, counts), strict=True):
        np.add.at(total, objects, each)
    return Tally(totals[0], totals[1], totals[2], totals[3])


def _squares(deposits: Longs) -> tuple[Longs, Longs]:
    """Whole numbers and the units beyond them; in halves, as a square of units has 128 bits."""
    whole, units = deposits.astype(np.uint64) >> BITS, deposits.astype(np.uint64) & MASK
    rest = 2 * whole * units + (units * units >> BITS)
    return (whole * whole + (rest >> BITS)).astype(np.int64), (rest & MASK).astype(np.int64)
