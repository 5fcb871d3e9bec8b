"""Which objects are resident on a PE besides its own: replicas, up to the memory's share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from simmpp.common.randomness import generator
from simmpp.common.units import half_up
from simmpp.placement.placement import Filling, Memory, Placement, Ranking, Residents
from simmpp.placement.rooms import AS_FRACTION
from simmpp.placement.uses import Ids, UsesByPE, uses
from simmpp.workload.workload import Workload


@dataclass(frozen=True, eq=False)
class Deal:
    """Who owns and who starts what."""

    workload: Workload
    owners: Ids
    """Within each island."""
    pixel_pes: Ids
    processors: int
    island: int
    """PEs of an island."""

    def is_owned(self, pe: int) -> NDArray[np.bool_]:
        """Which objects a PE owns: (N,) bool."""
        return self.owners == pe % self.island

    def not_owned(self, ranked: Ids, pe: int) -> Ids:
        """What of these objects a PE does not own, in their order."""
        return ranked[self.owners[ranked] != pe % self.island]


def replicas(deal: Deal, memory: Memory, seed: int) -> tuple[NDArray[np.int64], Ids]:
    """Replicas of each PE as CSR: offsets (nb + 1,) int64 and object ids int32.

    A PE's replicas are a prefix of one ranking of the objects it does not own, so a larger memory
    holds all that a smaller one held.
    """
    workload, owners, island = deal.workload, deal.owners, deal.island
    ranking = _ranking(memory, deal, seed)
    n_own = np.bincount(owners, minlength=island)
    own_bytes = np.zeros(island, np.int64)
    np.add.at(own_bytes, owners, workload.object_bytes)
    held: list[Ids] = []
    for pe in range(deal.processors):
        if memory.bytes is None:
            wanted = resident_count(memory.share, workload.n_objects) - int(n_own[pe % island])
            held.append(ranking(pe)[:wanted] if wanted > 0 else np.zeros(0, np.int32))
        else:
            room_bytes = memory.bytes - int(own_bytes[pe % island])
            held.append(_fitting(workload.object_bytes, ranking(pe), room_bytes))
    return as_csr(held)


def filling(deal: Deal, memory: Memory, seed: int) -> Filling | None:
    """What replicas are to take of the memory that is left, if that is asked for."""
    if not memory.fills:
        return None
    return Filling(_ranking(memory, deal, seed), memory.transient == AS_FRACTION)


def fill(
    placement: Placement,
    filling: Filling,
    object_bytes: NDArray[np.int64],
    rooms: NDArray[np.int64],
) -> Placement:
    """The placement with as many replicas as fit into so many bytes of each PE: (nb,) int64."""
    nb, n_objects = placement.processors, len(object_bytes)
    ranked = (_fitting(object_bytes, filling.ranking(pe), int(rooms[pe])) for pe in range(nb))
    offsets, objects = as_csr(list(ranked))
    kept = placement.transient
    if filling.keeps_as_many:
        kept = _residents_of_a_pe(n_objects, placement.island, len(objects), nb)
    return replace(
        placement,
        replica_offsets=offsets,
        replica_objects=objects,
        transient=kept,
        filling=None,
    )


def as_csr(held: Sequence[Ids]) -> tuple[NDArray[np.int64], Ids]:
    """What each PE holds, one after the other: offsets (nb + 1,) int64 and object ids int32."""
    offsets = np.concatenate([[0], np.cumsum([len(ids) for ids in held])]).astype(np.int64)
    return offsets, np.concatenate(held, dtype=np.int32)


def resident_count(fraction: Fraction, n_objects: int) -> int:
    """floor(x N + 1/2), exactly."""
    return half_up(fraction * n_objects)


def kept_count(memory: Memory, deal: Deal, n_replicas: int) -> int:
    """Fetched objects that a PE keeps: a share of all is rounded as the fraction's.

    ``n_replicas`` are those of all PEs together.
    """
    kept, n_objects = memory.kept, deal.workload.n_objects
    if isinstance(kept, int):
        return kept
    if isinstance(kept, Fraction):
        return resident_count(kept, n_objects)
    return _residents_of_a_pe(n_objects, deal.island, n_replicas, deal.processors)


def _residents_of_a_pe(n_objects: int, island: int, n_replicas: int, processors: int) -> int:
    """In the mean."""
    return half_up(Fraction(n_objects, island) + Fraction(n_replicas, processors))


def _fitting(object_bytes: NDArray[np.int64], ranked: Ids, room_bytes: int) -> Ids:
    """The longest prefix of the ranking that fits into what the PE's own objects leave."""
    total = np.cumsum(object_bytes[ranked])
    return ranked[: int(np.searchsorted(total, room_bytes, side="right"))]


def _hot_first(ranking: Ranking, share: Fraction, deal: Deal) -> Ranking:
    """The most used objects for their size before all others, on every PE the same."""
    workload = deal.workload
    n_hot = resident_count(share, workload.n_objects)
    per_byte = uses(workload) / np.maximum(workload.object_bytes, 1)
    hot = np.argsort(-per_byte, kind="stable")[:n_hot].astype(np.int32)

    def ranked(pe: int) -> Ids:
        others = ranking(pe)
        return np.concatenate([deal.not_owned(hot, pe), others[~np.isin(others, hot)]])

    return ranked


def _ranking(memory: Memory, deal: Deal, seed: int) -> Ranking:
    ranking = _rankings(memory.residents, deal, seed)
    return _hot_first(ranking, memory.hot, deal) if memory.hot > 0 else ranking


def _rankings(rule: Residents, deal: Deal, seed: int) -> Ranking:
    workload = deal.workload
    ids = np.arange(workload.n_objects, dtype=np.int32)
    if rule == "random":
        return lambda pe: generator(seed, "residents", pe).permutation(deal.not_owned(ids, pe))
    if rule == "hot":
        hottest = ids[np.lexsort((ids, -uses(workload)))]
        return lambda pe: deal.not_owned(hottest, pe)
    if rule == "used":
        return _used(UsesByPE(workload, deal.pixel_pes), deal)
    return lambda pe: _nearest(workload.object_centroids, deal.is_owned(pe))


def _used(by_pe: UsesByPE, deal: Deal) -> Ranking:
    """Objects by their uses on the PE for their size, then by those on all.

    Source: what a processor used last stays with it (Green and Paddon 1990), seen beforehand.
    """
    workload = deal.workload
    n_bytes, ids = np.maximum(workload.object_bytes, 1), np.arange(workload.n_objects)
    on_all = uses(workload) / n_bytes

    def ranked(pe: int) -> Ids:
        order = np.lexsort((ids, -on_all, -(by_pe.of(pe) / n_bytes))).astype(np.int32)
        return deal.not_owned(order, pe)

    return ranked


def _nearest(centroids: NDArray[np.float64], is_owned: NDArray[np.bool_]) -> Ids:
    """Objects by the distance of their centroid from the box of the PE's own centroids.

    A PE that owns nothing has no region; it takes objects in the order of their ids.
    """
    others = np.flatnonzero(~is_owned).astype(np.int32)
    own = centroids[is_owned]
    if len(own) == 0:
        return others
    low, high = own.min(axis=0), own.max(axis=0)
    points = centroids[others]
    outside = np.maximum(np.maximum(low - points, points - high), 0.0)
    outside = np.ldexp(outside, -np.frexp(outside.max(initial=0.0))[1])  # squares that fit
    return others[np.lexsort((others, (outside**2).sum(axis=1)))]
