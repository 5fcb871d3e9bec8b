"""What is recorded of particles, and what they leave in cells: arrays that compiled code fills."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel
from simmpp.workload.particles.grid import Floats, Longs

Ints = NDArray[np.int32]
LOST, BEHIND = 6, 7
"""Behind the tallies of N cells stand those of what left by each of six sides, and of what roulette
took; so many in all."""
PARTS = 4096
"""Parts of one root that wait for their turn."""
CELLS, RAYS, HEIGHT, BRANCHES, TOUCHED, FULL = range(6)
"""Counters: entries of the tables in use, parts that wait, branches so far, tallies touched, and
whether the parts were too many."""


class Tables(NamedTuple):
    """What is recorded of particles, root by root, each before its parts."""

    counters: Longs
    cells: Ints
    """(segments,) int32: the cell of each ..."""
    tracks: Longs
    """(segments,) int64: ... and weight times length, in units."""
    parents: Ints
    """(rays,) int32: number of the ray in these tables; -1 for a root."""
    depths: Ints
    """(rays,) int32: 0 for a root."""
    n_tests: Ints
    """(rays,) int32."""
    hits: Ints
    """(rays,) int32: the cell where it ended; -1 if it left."""
    distances: Floats
    """(rays,) float64: how far it flew; inf if it left."""


class Tally(NamedTuple):
    """Sums over roots, (N + 7,) int64; of one root where it is not yet over."""

    absorbed: Longs
    """Weight that stays in a cell; that leaves; that roulette takes less what it gives."""
    tracks: Longs
    """Weight times length."""
    visits: Longs
    """Segments."""
    absorbed_squares: Floats
    """Of each root's: float64, as whole numbers of 64 bits would not do."""
    track_squares: Floats
    touched: Longs
    """Of one root: which entries are not 0."""


class Parts(NamedTuple):
    """Particles that wait for their turn."""

    vectors: Floats
    """(PARTS, 6): position and direction."""
    numbers: Longs
    """(PARTS, 6): place, weight, parent, depth."""


@kernel
def fold(one: Tally, all_: Tally, n: int, counts: bool) -> None:
    """Empty the tally of a root, into that of all if it counts."""
    for i in range(n):
        k = one.touched[i]
        if counts:
            absorbed, track = one.absorbed[k], one.tracks[k]
            all_.absorbed[k] += absorbed
            all_.tracks[k] += track
            all_.visits[k] += one.visits[k]
            all_.absorbed_squares[k] += square(absorbed)
            all_.track_squares[k] += square(track)
        one.absorbed[k] = one.tracks[k] = one.visits[k] = 0


@kernel
def square(value: int) -> float:
    """In the same units of 2^-32, a whole number."""
    half = float(value >> 16)
    return half * half


@kernel
def visit(one: Tally, counters: Longs, k: int) -> None:
    """Count a visit, and note that entry ``k`` is no longer 0."""
    if one.visits[k] == 0:
        one.touched[counters[TOUCHED]] = k
        counters[TOUCHED] += 1
    one.visits[k] += 1


@kernel
def left(one: Tally, counters: Longs, k: int, weight: int) -> None:
    """Weight that goes to an entry behind those of cells."""
    visit(one, counters, k)
    one.absorbed[k] += weight
