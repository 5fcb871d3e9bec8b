"""What is resident on each PE, as compiled code looks it up: bits, or sorted ids."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import njit
from simmpp.placement.placement import Placement
from simmpp.workload.workload import Workload

Arrays = dict[str, NDArray[Any]]


def row_bytes(placement: Placement, n_objects: int) -> int:
    """Bytes of a PE's row of bits; 0 if sorted ids take less memory."""
    as_bits = (n_objects + 7) // 8
    return as_bits if as_bits * placement.processors <= placement.replica_objects.nbytes else 0


def resident_arrays(workload: Workload, placement: Placement, everything: bool) -> Arrays:
    """The arrays ``resident``, ``replica_offsets`` and ``replica_objects`` of a run.

    Replicas are kept as bits or as ids, whichever takes less memory; nothing is kept if
    ``everything`` is in every memory.
    """
    nothing: Arrays = {
        "resident": np.zeros(0, np.uint8),
        "replica_offsets": np.zeros(0, np.int64),
        "replica_objects": np.zeros(0, np.int32),
    }
    if everything or len(placement.replica_objects) == 0:
        return nothing
    length = row_bytes(placement, workload.n_objects)
    if length:
        bits = np.zeros((placement.processors, length), np.uint8)
        _set_bits(bits, placement.replica_offsets, placement.replica_objects)
        return nothing | {"resident": bits.reshape(-1)}
    ids = placement.replica_objects.copy()
    _sort_rows(ids, placement.replica_offsets)
    return nothing | {"replica_offsets": placement.replica_offsets, "replica_objects": ids}


def holder_arrays(workload: Workload, placement: Placement, *, wanted: bool) -> Arrays:
    """The arrays ``holder_offsets`` and ``holder_pes`` of a run; empty if not wanted."""
    if not wanted:
        return {"holder_offsets": np.zeros(0, np.int64), "holder_pes": np.zeros(0, np.int32)}
    nb, n_objects = placement.processors, workload.n_objects
    replicas = np.repeat(np.arange(nb, dtype=np.int32), np.diff(placement.replica_offsets))
    firsts = np.arange(0, nb, placement.island)  # of each island, whose owners are counted from it
    owners = np.add.outer(firsts, placement.owners).reshape(-1)
    owned = np.tile(np.arange(n_objects), placement.islands)
    objects = np.concatenate([owned, placement.replica_objects])
    holders = np.concatenate([owners, replicas]).astype(np.int32)
    counts = np.bincount(objects, minlength=n_objects)
    return {
        "holder_offsets": np.concatenate([[0], np.cumsum(counts)]).astype(np.int64),
        "holder_pes": holders[np.lexsort((holders, objects))],
    }


def resident_bytes(workload: Workload, placement: Placement, everything: bool) -> NDArray[np.int64]:
    """Bytes of the objects resident on each PE: (nb,) int64."""
    if everything:
        return np.full(placement.processors, workload.object_bytes.sum(), np.int64)
    owned = np.zeros(placement.island, np.int64)
    np.add.at(owned, placement.owners, workload.object_bytes)
    total = np.tile(owned, placement.islands)
    offsets, objects = placement.replica_offsets, placement.replica_objects
    _add_bytes(total, offsets, objects, workload.object_bytes)
    return total


@njit
def _set_bits(
    bits: NDArray[np.uint8], offsets: NDArray[np.int64], objects: NDArray[np.int32]
) -> None:
    for pe in range(offsets.size - 1):
        for at in range(offsets[pe], offsets[pe + 1]):
            bits[pe, objects[at] >> 3] |= np.uint8(1 << (objects[at] & 7))


@njit
def _sort_rows(objects: NDArray[np.int32], offsets: NDArray[np.int64]) -> None:
    for pe in range(offsets.size - 1):
        objects[offsets[pe] : offsets[pe + 1]].sort()


@njit
def _add_bytes(
    total: NDArray[np.int64],
    offsets: NDArray[np.int64],
    objects: NDArray[np.int32],
    object_bytes: NDArray[np.int64],
) -> None:
    for pe in range(offsets.size - 1):
        for at in range(offsets[pe], offsets[pe + 1]):
            total[pe] += object_bytes[objects[at]]
