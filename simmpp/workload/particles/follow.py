"""Follows all particles of a source, batch by batch, on as many threads as there are."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np

from simmpp.common.errors import ConfigError
from simmpp.workload.particles.grid import Grid, Rules
from simmpp.workload.particles.tables import (
    BEHIND,
    CELLS,
    FULL,
    PARTS,
    RAYS,
    Parts,
    Tables,
    Tally,
)
from simmpp.workload.particles.walk import walk
from simmpp.workload.threads import Run

ROOTS = 4096
"""Of a batch, at least."""
BATCHES = 64
"""At most, as each has a tally."""
SEGMENTS, RAYS_OF = 2**20, 2**16
"""That tables hold at first."""
MOST_SEGMENTS = 2**24
"""Of one root: a particle that does not end would fill the memory."""


class Followed(NamedTuple):
    """What became of a run of roots."""

    tables: list[Tables]
    """One after the other, without room to spare."""
    tally: Tally


def follow(grid: Grid, rules: Rules, count: int, run: Run) -> Iterator[tuple[int, Followed]]:
    """Batches in the order of their roots, and the number of roots so far."""
    size = max(ROOTS, -(-count // BATCHES))
    lows = range(0, count, size)
    highs = [min(low + size, count) for low in lows]
    batches: Iterable[Followed] = run(partial(batch, grid, rules), lows, highs)
    yield from zip(highs, batches, strict=True)


def batch(grid: Grid, rules: Rules, first: int, last: int) -> Followed:
    """Roots first ... last - 1: into tables as they get full, larger ones where a root needs it."""
    one, tally, filled, growth = empty_tally(grid), empty_tally(grid), [], 1
    parts = Parts(np.empty((PARTS, 6)), np.empty((PARTS, 6), np.int64))
    while first < last:
        tables = _tables(growth * SEGMENTS, growth * RAYS_OF)
        reached = walk(grid, rules, first, last, tables, one, tally, parts)
        if reached > first:
            filled.append(_used(tables))
        else:
            _refuse_endless(tables, first)
            growth *= 2
        first = reached
    return Followed(filled, tally)


def empty_tally(grid: Grid) -> Tally:
    """Zeros of each cell, and of what is counted besides."""
    n = len(grid.material_of) + BEHIND
    absorbed, tracks, visits, touched = (np.zeros(n, np.int64) for _ in range(4))
    return Tally(absorbed, tracks, visits, np.zeros(n), np.zeros(n), touched)


def added(tally: Tally, more: Tally) -> None:
    """Add the sums of other roots."""
    tally.absorbed[:] += more.absorbed
    tally.tracks[:] += more.tracks
    tally.visits[:] += more.visits
    tally.absorbed_squares[:] += more.absorbed_squares
    tally.track_squares[:] += more.track_squares


def _tables(segments: int, rays: int) -> Tables:
    return Tables(
        counters=np.zeros(FULL + 1, np.int64),
        cells=np.empty(segments, np.int32),
        tracks=np.empty(segments, np.int64),
        parents=np.empty(rays, np.int32),
        depths=np.empty(rays, np.int32),
        n_tests=np.empty(rays, np.int32),
        hits=np.empty(rays, np.int32),
        distances=np.empty(rays),
    )


def _used(tables: Tables) -> Tables:
    """Copies of what is used, so that the rest is free again."""
    segments, rays = tables.counters[CELLS], tables.counters[RAYS]
    return Tables(
        counters=tables.counters,
        cells=tables.cells[:segments].copy(),
        tracks=tables.tracks[:segments].copy(),
        parents=tables.parents[:rays].copy(),
        depths=tables.depths[:rays].copy(),
        n_tests=tables.n_tests[:rays].copy(),
        hits=tables.hits[:rays].copy(),
        distances=tables.distances[:rays].copy(),
    )


def _refuse_endless(tables: Tables, root: int) -> None:
    """Raise ConfigError for a root that no tables would hold."""
    if tables.counters[FULL]:
        problem = f"particle {root} is split into more than {PARTS} parts at a time"
        raise ConfigError(
            f"{problem}: expected importances that rise more slowly", where="scene.cells"
        )
    if len(tables.cells) >= MOST_SEGMENTS:
        problem = f"particle {root} flies through more than {len(tables.cells)} cells"
        raise ConfigError(f"{problem}: expected more absorption, or a way out", where="scene.cells")
