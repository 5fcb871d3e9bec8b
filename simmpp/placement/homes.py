"""Roots that have a home start where it is: with the owner of the object, or who holds it as well.

A particle begins in its cell, a form-factor ray on its patch; whoever owns that has it in memory.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import ConfigError
from simmpp.placement.placement import Placement, cut
from simmpp.placement.uses import Ids
from simmpp.workload.workload import Workload


def home_starts(workload: Workload, owner_of: Ids, processors: int, island: int) -> Ids:
    """The PE of each root: the owner of its home; (n0,) int32.

    With islands the roots of one home are cut into as many parts, in their order. Those without a
    home are dealt in blocks.

    Raises ConfigError where no root has a home.
    """
    homes = workload.root_homes
    if len(homes) == 0:
        problem = f"value home: no ray of {workload.name} has one: expected another way to deal"
        raise ConfigError(problem, where="placement.pixels")
    starts = np.empty(len(homes), np.int32)
    away = homes < 0
    starts[away] = cut(int(away.sum()), processors)
    rank, count = _ranks(homes[~away])
    in_island = rank * (processors // island) // count
    starts[~away] = in_island * island + owner_of[homes[~away]]
    return starts


def spread(workload: Workload, placement: Placement) -> Ids:
    """The same, but roots of one home beyond n0 / nb go in turn to the PEs of the island that hold
    a replica of it, if there are any."""
    homes, starts = workload.root_homes, placement.pixel_pes.copy()
    most = -(-len(homes) // placement.processors)
    pes = np.repeat(np.arange(placement.processors), np.diff(placement.replica_offsets))
    base = starts - starts % placement.island
    for home in np.flatnonzero(np.bincount(homes[homes >= 0]) > most):
        holders = pes[placement.replica_objects == home]
        for island in np.unique(base[homes == home]):
            roots = np.flatnonzero((homes == home) & (base == island))[most:]
            near = holders[(holders >= island) & (holders < island + placement.island)]
            if len(near):
                starts[roots] = near[np.arange(len(roots)) % len(near)]
    return starts


def _ranks(homes: Ids) -> tuple[NDArray[np.int64], NDArray[np.signedinteger]]:
    """The how many-th of its home each root is, from 0, and how many there are of that home."""
    order, count = np.argsort(homes, kind="stable"), np.bincount(homes)
    first = np.cumsum(count) - count
    rank = np.empty(len(homes), np.int64)
    rank[order] = np.arange(len(homes)) - first[homes[order]]
    return rank, count[homes]
