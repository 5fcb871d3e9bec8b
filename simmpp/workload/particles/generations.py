"""Particles are followed root by root, and numbered as rays are: generation by generation."""

from __future__ import annotations

import numpy as np

from simmpp.common.compiled import njit
from simmpp.workload.particles.grid import Longs
from simmpp.workload.particles.tables import Ints, Tables


def joined(batches: list[Tables]) -> Tables:
    """All tables as one, in the numbering of workloads; the list is left empty."""
    starts = np.cumsum([0, *(len(tables.hits) for tables in batches)])
    for tables, start in zip(batches, starts, strict=False):
        tables.parents[tables.parents >= 0] += np.int32(start)
    columns = [list(column) for column in zip(*batches, strict=True)]
    batches.clear()
    wholes = []
    while columns:  # each is freed once it is copied
        wholes.append(np.concatenate(columns.pop(0)))
    whole = Tables(*wholes)
    return _by_generation(whole) if whole.depths.any() else whole


def _by_generation(tables: Tables) -> Tables:
    """The same in the order of generations, within one of parents, within one as they were."""
    order, numbers = _order(tables)
    parents = tables.parents[order]
    parents[parents >= 0] = numbers[parents[parents >= 0]]
    starts = np.cumsum(tables.n_tests, dtype=np.int64) - tables.n_tests
    places = np.empty(len(tables.cells), np.int64)
    _places(order, starts, tables.n_tests, places)
    return Tables(
        counters=tables.counters,
        cells=tables.cells[places],
        tracks=tables.tracks[places],
        parents=parents,
        depths=tables.depths[order],
        n_tests=tables.n_tests[order],
        hits=tables.hits[order],
        distances=tables.distances[order],
    )


def _order(tables: Tables) -> tuple[Longs, Ints]:
    """Which ray is where, and the new number of each."""
    numbers = np.empty(len(tables.hits), np.int32)
    by_depth = np.argsort(tables.depths, kind="stable")
    ends = np.cumsum(np.bincount(tables.depths))
    order, start = [], 0
    for end in ends:
        rays = by_depth[start:end]
        if start:
            rays = rays[np.argsort(numbers[tables.parents[rays]], kind="stable")]
        numbers[rays] = np.arange(start, end)
        order.append(rays)
        start = end
    return np.concatenate(order), numbers


@njit
def _places(order: Longs, starts: Longs, n_tests: Ints, places: Longs) -> None:
    """Where each segment was."""
    at = 0
    for ray in order:
        for k in range(n_tests[ray]):
            places[at] = starts[ray] + k
            at += 1
